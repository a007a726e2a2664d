// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/RunDeflate.h"

#include "tetvdb/print/HuffmanLengths.h"

#include <algorithm>
#include <array>

namespace tetvdb {
namespace {

constexpr std::size_t kEnd = 256;
constexpr std::size_t kSymbols = 286;
constexpr std::uint64_t kLongest = 258;
constexpr std::uint64_t kShortest = 3;
constexpr std::size_t kLongestSymbol = 285;

// The symbol of a match's length, and its additional bits.
struct LengthCode {
  std::uint16_t symbol;
  std::uint8_t bits;
  std::uint8_t value;
};

std::array<LengthCode, kLongest + 1> makeLengthCodes() {
  std::array<LengthCode, kLongest + 1> codes{};
  std::size_t length = kShortest, symbol = 257;
  for (; symbol < kLongestSymbol; ++symbol) {
    const auto bits = static_cast<std::uint8_t>(symbol < 265 ? 0 : (symbol - 261) / 4);
    for (std::size_t i = 0; i < std::size_t(1) << bits && length < kLongest; ++i)
      codes[length++] = {static_cast<std::uint16_t>(symbol), bits, static_cast<std::uint8_t>(i)};
  }
  codes[kLongest] = {kLongestSymbol, 0, 0};
  return codes;
}

const std::array<LengthCode, kLongest + 1>& lengthCodes() {
  static const auto codes = makeLengthCodes();
  return codes;
}

// A run as single bytes, matches of maximum length and one other match.
struct Tokens {
  std::uint64_t singles, longest, other;
};

Tokens tokensOf(std::uint64_t count) {
  Tokens tokens{1, (count - 1) / kLongest, (count - 1) % kLongest};
  if (tokens.other < kShortest) {
    tokens.singles += tokens.other;
    tokens.other = 0;
  }
  return tokens;
}

// Bits, the lowest of each word first.
class BitWriter {
public:
  void write(std::uint32_t word, int bits) {
    pending_ |= std::uint64_t(word) << count_;
    count_ += bits;
    while (count_ >= 8) {
      bytes_ += static_cast<char>(pending_ & 0xff);
      pending_ >>= 8;
      count_ -= 8;
    }
  }
  // After the first word, eight words occupy whole bytes, which are then repeated.
  void repeat(std::uint32_t word, int bits, std::uint64_t times) {
    const auto period = static_cast<std::size_t>(bits);
    for (std::uint64_t single = times < 24 ? times : 8 + times % 8; single > 0; --single, --times)
      write(word, bits);
    if (times == 0)
      return;
    const std::size_t begin = bytes_.size();
    for (int i = 0; i < 8; ++i)
      write(word, bits);
    const std::size_t end = begin + static_cast<std::size_t>(times / 8) * period;
    while (bytes_.size() < end)
      bytes_.append(bytes_, begin, std::min(bytes_.size() - begin, end - bytes_.size()));
  }
  std::string& finish() {
    if (count_ > 0)
      write(0, 8 - count_);
    return bytes_;
  }

private:
  std::string bytes_;
  std::uint64_t pending_ = 0;
  int count_ = 0;
};

// The header of a block with dynamic codes (RFC 1951, 3.2.7): lengths of the words for bytes and
// lengths, and 1 for the only distance.
void writeCodes(const std::vector<std::uint8_t>& lengths, BitWriter& out) {
  constexpr std::array<std::size_t, 19> order = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                 11, 4,  12, 3, 13, 2, 14, 1, 15};
  std::vector<std::uint8_t> all = lengths;
  all.push_back(1);
  struct Code {
    std::uint8_t symbol, bits, value;
  };
  std::vector<Code> codes;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t same = 1;
    while (i + same < all.size() && all[i + same] == all[i])
      ++same;
    if (all[i] == 0 && same >= 3) {
      same = std::min<std::size_t>(same, 138);
      if (same < 11)
        codes.push_back({17, 3, static_cast<std::uint8_t>(same - 3)});
      else
        codes.push_back({18, 7, static_cast<std::uint8_t>(same - 11)});
    } else if (same >= 4) {
      same = std::min<std::size_t>(same, 7);
      codes.push_back({all[i], 0, 0});
      codes.push_back({16, 2, static_cast<std::uint8_t>(same - 4)});
    } else {
      same = 1;
      codes.push_back({all[i], 0, 0});
    }
    i += same;
  }
  std::vector<std::uint64_t> counts(order.size(), 0);
  for (const Code& code : codes)
    ++counts[code.symbol];
  const std::vector<std::uint8_t> bits = huffmanLengths(counts, 7);
  const std::vector<std::uint16_t> words = huffmanWords(bits);
  std::size_t used = order.size();
  while (used > 4 && bits[order[used - 1]] == 0)
    --used;
  out.write(static_cast<std::uint32_t>(lengths.size() - 257), 5);
  out.write(0, 5); // one distance
  out.write(static_cast<std::uint32_t>(used - 4), 4);
  for (std::size_t i = 0; i < used; ++i)
    out.write(bits[order[i]], 3);
  for (const Code& code : codes) {
    out.write(words[code.symbol], bits[code.symbol]);
    out.write(code.value, code.bits);
  }
}

} // namespace

std::string RunDeflate::finish() {
  std::vector<std::uint64_t> counts(kSymbols, 0);
  RunAdler adler;
  counts[kEnd] = 1;
  for (const Run& run : runs_) {
    adler.add(run.value, run.count);
    const Tokens tokens = tokensOf(run.count);
    counts[run.value] += tokens.singles;
    counts[kLongestSymbol] += tokens.longest;
    if (tokens.other > 0)
      ++counts[lengthCodes()[tokens.other].symbol];
  }
  while (counts.size() > kEnd + 1 && counts.back() == 0)
    counts.pop_back();
  const std::vector<std::uint8_t> lengths = huffmanLengths(counts, 15);
  const std::vector<std::uint16_t> words = huffmanWords(lengths);

  BitWriter out;
  out.write(0x78, 8); // deflate, window of 32 KB
  out.write(0x9c, 8);
  out.write(1, 1); // the last block
  out.write(2, 2); // dynamic codes
  writeCodes(lengths, out);
  for (const Run& run : runs_) {
    const Tokens tokens = tokensOf(run.count);
    out.repeat(words[run.value], lengths[run.value], tokens.singles);
    // The distance's word is a 0 bit after the length.
    if (tokens.longest > 0)
      out.repeat(words[kLongestSymbol], lengths[kLongestSymbol] + 1, tokens.longest);
    if (tokens.other > 0) {
      const LengthCode& code = lengthCodes()[tokens.other];
      out.write(words[code.symbol], lengths[code.symbol]);
      out.write(code.value, code.bits + 1);
    }
  }
  out.write(words[kEnd], lengths[kEnd]);
  std::string bytes = std::move(out.finish());
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes += static_cast<char>(adler.sum() >> shift & 0xff);
  runs_.clear();
  return bytes;
}

void RunAdler::add(std::uint8_t value, std::uint64_t count) {
  constexpr std::uint64_t kPrime = 65521;
  const std::uint64_t n = count % kPrime;
  // n (n + 1) / 2, the even factor halved.
  const std::uint64_t half = count % 2 == 0 ? (count / 2 % kPrime) * ((count + 1) % kPrime)
                                            : ((count + 1) / 2 % kPrime) * n;
  b_ = static_cast<std::uint32_t>((b_ + n * a_ + half % kPrime * value) % kPrime);
  a_ = static_cast<std::uint32_t>((a_ + n * value) % kPrime);
}

} // namespace tetvdb
