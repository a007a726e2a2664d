// SPDX-License-Identifier: Apache-2.0
//
// Result files as their programs write them: a unit cube (nodes 1 to 8) with a pyramid of height 1
// on top (apex: node 9), of the regions 1 and 2.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

namespace tetvdb::test {

/// printf into a string.
template <class... T>
std::string printed(const char* format, T... values) {
  std::array<char, 256> text{};
  const int n = std::snprintf(text.data(), text.size(), format, values...);
  return {text.data(), static_cast<std::size_t>(n)};
}

constexpr double kCubeAndTip[9][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},    {0, 0, 1},
                                      {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 2}};

template <class T>
void addBytes(std::string& to, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  to.append(bytes, sizeof value);
}

/// A block of values of CalculiX: `nodes` from `first` on, value(node, component).
template <class Value>
std::string frdResult(int form, const char* name, int step, double time, int first, int nodes,
                      int components, Value value) {
  std::string text = printed("  %sC%6s%12.5E%12d%20s%2d%5d%10s%2d\n", "100", "L", time, nodes, "",
                             0, step, "", form);
  text += printed(" -4  %-8s%5d%5d\n", name, components + 1, 1);
  for (int c = 0; c < components; ++c)
    text += printed(" -5  D%-7d%5d%5d%5d%5d\n", c, 1, 2, c + 1, 0);
  text += " -5  ALL         1    2    0    0    1ALL\n";
  for (int i = first; i < first + nodes; ++i) {
    if (form >= 2)
      addBytes<std::int32_t>(text, i + 1);
    for (int c = 0; c < components; ++c) {
      if (form == 2)
        addBytes<float>(text, static_cast<float>(value(i, c)));
      else if (form == 3)
        addBytes<double>(text, value(i, c));
      else
        text += (c == 0       ? printed(form == 0 ? " -1%5d" : " -1%10d", i + 1)
                 : c % 6 == 0 ? printed(form == 0 ? "\n -2%5s" : "\n -2%10s", "")
                              : "") +
                printed("%12.5E", value(i, c));
    }
    if (form < 2)
      text += "\n";
  }
  return text + (form < 2 ? " -3\n" : "");
}

/// Of short text (0), long text (1), floats (2) or doubles (3); elements have no doubles.
inline std::string frdFile(int form) {
  std::string text = "    1C\n    1UDATE 22.november\n    1UMAT    1WATER\n    1UMAT    2STEEL\n";
  text += printed("    2C%18s%12d%37s%d\n", "", 9, "", form);
  for (int i = 0; i < 9; ++i) {
    if (form >= 2)
      addBytes<std::int32_t>(text, i + 1);
    else
      text += printed(form == 0 ? " -1%5d" : " -1%10d", i + 1);
    for (const double x : kCubeAndTip[i])
      if (form == 2)
        addBytes<float>(text, static_cast<float>(x));
      else if (form == 3)
        addBytes<double>(text, x);
      else
        text += printed("%12.5E", x);
    if (form < 2)
      text += "\n";
  }
  if (form < 2)
    text += " -3\n";
  // The cube, and half of the pyramid as a tet.
  const int elements = 2, types[2] = {1, 3};
  const int nodes[2][8] = {{1, 2, 3, 4, 5, 6, 7, 8}, {5, 6, 7, 9}};
  text += printed("    3C%18s%12d%37s%d\n", "", elements, "", form >= 2 ? 2 : form);
  for (int e = 0; e < elements; ++e) {
    const int n = e == 0 ? 8 : 4;
    if (form >= 2) {
      for (const int number : {e + 1, types[e], 0, e + 1})
        addBytes<std::int32_t>(text, number);
      for (int k = 0; k < n; ++k)
        addBytes<std::int32_t>(text, nodes[e][k]);
      continue;
    }
    text += printed(form == 0 ? " -1%5d%5d%5d%5d\n -2" : " -1%10d%5d%5d%5d\n -2", e + 1, types[e],
                    0, e + 1);
    for (int k = 0; k < n; ++k)
      text += printed(form == 0 ? "%5d" : "%10d", nodes[e][k]);
    text += "\n";
  }
  if (form < 2)
    text += " -3\n";
  for (int step = 1; step <= 2; ++step) {
    text += printed("    1PSTEP%24d%12d%12d\n", step, 1, step);
    text += frdResult(form, "DISP", step, 0.5 * step, 0, 9, 3,
                      [&](int i, int c) { return step * i + 0.25 * c; });
    text += frdResult(form, "STRESS", step, 0.5 * step, 1, 8, 7,
                      [&](int i, int c) { return -i - c / 12.0; });
  }
  return text + " 9999\n";
}

/// A hexahedron of 20 nodes, in CalculiX's order: the mids of vertical edges before those above.
inline std::string frdQuadratic() {
  constexpr int edges[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 5},
                                {2, 6}, {3, 7}, {4, 5}, {5, 6}, {6, 7}, {7, 4}};
  std::string text = "    1C\n" + printed("    2C%18s%12d%37s%d\n", "", 20, "", 1);
  for (int i = 0; i < 20; ++i) {
    text += printed(" -1%10d", i + 1);
    for (int k = 0; k < 3; ++k)
      text +=
          printed("%12.5E",
                  i < 8 ? kCubeAndTip[i][k]
                        : (kCubeAndTip[edges[i - 8][0]][k] + kCubeAndTip[edges[i - 8][1]][k]) / 2);
    text += "\n";
  }
  text += " -3\n" + printed("    3C%18s%12d%37s%d\n -1%10d%5d%5d%5d", "", 1, "", 1, 7, 4, 0, 0);
  for (int i = 0; i < 20; ++i)
    text += (i % 10 == 0 ? "\n -2" : "") + printed("%10d", i + 1);
  return text + "\n -3\n 9999\n";
}

/// A quadrilateral and a triangle.
inline std::string frdShells() {
  std::string text = frdFile(1);
  text = text.substr(0, text.find("    3C"));
  return text + printed("    3C%18s%12d%37s%d\n", "", 2, "", 1) +
         printed(" -1%10d%5d%5d%5d\n -2%10d%10d%10d%10d\n", 1, 9, 0, 1, 1, 2, 3, 4) +
         printed(" -1%10d%5d%5d%5d\n -2%10d%10d%10d\n -3\n 9999\n", 2, 7, 0, 1, 2, 3, 6);
}

/// A Gambit neutral file; bricks and pyramids around their bases, or row by row as Gambit has them.
inline std::string neuFile(bool byRows) {
  std::string text =
      "        CONTROL INFO 2.4.6\n** GAMBIT NEUTRAL FILE\ncube\nPROGRAM:   Gambit     "
      "VERSION:  2.4.6\n 19 Apr 2010    14:11:32\n     NUMNP     NELEM     NGRPS    "
      "NBSETS     NDFCD     NDFVL\n";
  text += printed("%10d%10d%10d%10d%10d%10d\nENDOFSECTION\n   NODAL COORDINATES 2.4.6\n", 9, 3, 2,
                  1, 3, 3);
  for (int i = 0; i < 9; ++i)
    text += printed("%10d%20.11e%20.11e%20.11e\n", i + 1, kCubeAndTip[i][0], kCubeAndTip[i][1],
                    kCubeAndTip[i][2]);
  text += "ENDOFSECTION\n      ELEMENTS/CELLS 2.4.6\n";
  text +=
      byRows ? "       1  4  8        1       2       4       3       5       6       8\n"
               "                      7\n       5  7  5        5       6       8       7       9\n"
             : "       1  4  8        1       2       3       4       5       6       7\n"
               "                      8\n       5  7  5        5       6       7       8       9\n";
  text += "       6  3  3        1       2       3\nENDOFSECTION\n       ELEMENT GROUP 2.4.6\n"
          "GROUP:          1 ELEMENTS:          1 MATERIAL:          2 NFLAGS:          1\n"
          "                           water\n       0\n       1\nENDOFSECTION\n"
          "       ELEMENT GROUP 2.4.6\n"
          "GROUP:          7 ELEMENTS:          1 MATERIAL:          2 NFLAGS:          1\n"
          "                           roof\n       0\n       5\nENDOFSECTION\n"
          " BOUNDARY CONDITIONS 2.4.6\n inlet  1 1 0 6\n 1 4 1\nENDOFSECTION\n";
  return text;
}

/// A hexahedron with a pyramid on it, beside it in a second zone a tet, and a triangle of a marker.
inline std::string su2File() {
  std::string text = "% of SU2\nNZONE= 2\nIZONE= 1\nNDIME= 3\nNELEM= 2\n"
                     "12 0 1 2 3 4 5 6 7 0\n14 4 5 6 7 8 1\nNPOIN= 9 % and no halo\n";
  for (int i = 0; i < 9; ++i)
    text += printed("%.16e %.16e %.16e %d\n", kCubeAndTip[i][0], kCubeAndTip[i][1],
                    kCubeAndTip[i][2], i);
  return text + "NMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 1\n5 0 1 2\nIZONE= 2\nNDIME=3\n"
                "NPOIN=4\n5 0 0\n6 0 0\n5 1 0\n5 0 1\nNELEM=1\n10 0 1 2 3\n";
}

/// A universal file of a hexahedron and a tet of ten nodes, in two groups, with a beam, a face,
/// units and a dataset that is not known.
inline std::string unvFile() {
  std::string text = "    -1\n   164\n         1  SI: Meter (newton)         2\n"
                     "   1.00000000000000D+00   1.00000000000000D+00   1.00000000000000D+00\n"
                     "    -1\n    -1\n   999\n -1 2\nwhatever\n    -1\n    -1\n  2411\n";
  const auto node = [&](int id, double x, double y, double z) {
    text +=
        printed("%10d%10d%10d%10d\n", id, 1, 1, 11) + printed("%25.16E%25.16E%25.16E\n", x, y, z);
  };
  for (int i = 0; i < 8; ++i)
    node(10 * i + 10, kCubeAndTip[i][0], kCubeAndTip[i][1], kCubeAndTip[i][2]);
  // Around the base of a tet with an edge of 2 beside it, then up.
  const double tet[10][3] = {{4, 0, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {4, 2, 0},
                             {4, 1, 0}, {4, 0, 1}, {5, 0, 1}, {4, 1, 1}, {4, 0, 2}};
  for (int i = 0; i < 10; ++i)
    node(101 + i, tet[i][0], tet[i][1], tet[i][2]);
  const auto element = [&](int id, int descriptor, int nodes) {
    text += printed("%10d%10d%10d%10d%10d%10d\n", id, descriptor, 1, 1, 7, nodes);
  };
  text += "    -1\n    -1\n  2412\n";
  element(1, 21, 2);
  text += "         0         1         1\n        10        20\n";
  element(5, 115, 8);
  text += "        10        20        30        40        50        60        70        80\n";
  element(7, 118, 10);
  text += "       101       102       103       104       105       106       107       108\n"
          "       109       110\n";
  element(9, 91, 3);
  text += "        10        20        30\n    -1\n    -1\n  2467\n";
  text += printed("%10d%10d%10d%10d%10d%10d%10d%10d\nrotor\n", 3, 0, 0, 0, 0, 0, 0, 3) +
          printed("%10d%10d%10d%10d%10d%10d%10d%10d\n", 7, 10, 0, 0, 8, 5, 0, 0) +
          printed("%10d%10d%10d%10d\n", 8, 9, 0, 0);
  return text + printed("%10d%10d%10d%10d%10d%10d%10d%10d\nstator\n", 4, 0, 0, 0, 0, 0, 0, 1) +
         printed("%10d%10d%10d%10d\n    -1\n", 8, 7, 0, 0);
}

} // namespace tetvdb::test
