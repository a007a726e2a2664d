// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Lengths of an optimal prefix code whose words have at most `limit` bits, by package-merge
/// (Larmore and Hirschberg, "A fast algorithm for optimal length-limited Huffman codes", 1990).
/// Symbols that do not occur have length 0, a single occurring symbol 1. At most 2^limit symbols
/// may occur. Deterministic.
std::vector<std::uint8_t> huffmanLengths(const std::vector<std::uint64_t>& counts, int limit);

/// The words of the code with these lengths, as numbered by deflate (RFC 1951, 3.2.2), with
/// reversed bits, so that the first is the lowest.
std::vector<std::uint16_t> huffmanWords(const std::vector<std::uint8_t>& lengths);

} // namespace tetvdb
