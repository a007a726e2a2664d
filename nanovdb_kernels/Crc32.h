// SPDX-License-Identifier: Apache-2.0
//
// CRC-32 (the polynomial of zlib and NanoVDB) in parts: the sum of A followed by B is the sum of A
// times x^(8 length of B), plus that of B, modulo the polynomial.
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

/// x^(8 bytes).
TETVDB_HD inline u32 crcPower(u64 bytes) {
  u32 result = 0x80000000u, square = 0x00800000u; // 1, x^8
  for (; bytes != 0; bytes >>= 1) {
    if (bytes & 1)
      result = crcMultiply(square, result);
    square = crcMultiply(square, square);
  }
  return result;
}

/// Of the bytes alone: register 0 before, nothing inverted.
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
