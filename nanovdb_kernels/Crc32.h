// SPDX-License-Identifier: Apache-2.0
//
// CRC-32 (the polynomial of zlib and NanoVDB) from the sums of parts: the sum of A followed by B is
// the sum of A times x^(8 length of B), plus that of B, modulo the polynomial.
#pragma once

#include "Team.h"

namespace tetvdb::nano {

constexpr u32 kCrcPolynomial = 0xEDB88320u; // bits reversed

/// Product of two polynomials modulo the CRC's, bits reversed: x^0 is the highest.
TETVDB_HD inline u32 crcMultiply(u32 a, u32 b) {
  u32 product = 0;
  for (u32 bit = 0x80000000u; bit != 0; bit >>= 1) {
    if (a & bit)
      product ^= b;
    b = (b & 1) != 0 ? (b >> 1) ^ kCrcPolynomial : b >> 1;
  }
  return product;
}

/// x^(8 bytes), by the squares of x^8.
TETVDB_HD inline u32 crcPower(u64 bytes) {
  constexpr int kSquares = 24;
  constexpr u32 squares[kSquares] = {
      0x00800000u, 0x00008000u, 0xEDB88320u, 0xB1E6B092u, 0xA06A2517u, 0xED627DAEu,
      0x88D14467u, 0xD7BBFE6Au, 0xEC447F11u, 0x8E7EA170u, 0x6427800Eu, 0x4D47BAE0u,
      0x09FE548Fu, 0x83852D0Fu, 0x30362F1Au, 0x7B5A9CC3u, 0x31FEC169u, 0x9FEC022Au,
      0x6C8DEDC4u, 0x15D6874Du, 0x5FDE7A4Eu, 0xBAD90E37u, 0x2E4E5EEFu, 0x4EABA214u};
  u32 result = 0x80000000u; // 1
  u32 square = squares[kSquares - 1];
  for (int k = 0; bytes != 0; ++k, bytes >>= 1) {
    square = k < kSquares ? squares[k] : crcMultiply(square, square);
    if (bytes & 1)
      result = crcMultiply(square, result);
  }
  return result;
}

/// The sum of the bytes with the register 0 at first and nothing inverted.
TETVDB_HD inline u32 crcOf(const u8* bytes, u64 size) {
  u32 crc = 0;
  for (u64 i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int k = 0; k < 8; ++k)
      crc = (crc & 1) != 0 ? (crc >> 1) ^ kCrcPolynomial : crc >> 1;
  }
  return crc;
}

} // namespace tetvdb::nano
