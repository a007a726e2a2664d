// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace tetvdb {
namespace {

constexpr int kWide = 5, kHigh = 7, kDrop = 2, kAdvance = 6;

// Seven rows of five dots, a byte a row from the top, the left dot in bit 4; ' ' to '~'.
constexpr std::array<std::uint64_t, 95> kGlyphs = {
    0x00000000000000, 0x04040404040004, 0x0A0A0A00000000, 0x0A0A1F0A1F0A0A, // space ! " #
    0x040F140E051E04, 0x18190204081303, 0x0C12140815120D, 0x04040800000000, // $ % & '
    0x02040808080402, 0x08040202020408, 0x00150E1F0E1500, 0x0004041F040400, // ( ) * +
    0x000000000C0408, 0x0000000E000000, 0x00000000000C0C, 0x01010204081010, // , - . /
    0x0E11111511110E, 0x040C140404041F, 0x0E11010E10101F, 0x1E01010E01011E, // 0 1 2 3
    0x02060A121F0202, 0x1F10101E01011E, 0x0E10101E11110E, 0x1F010204040808, // 4 5 6 7
    0x0E11110E11110E, 0x0E11110F01010E, 0x000C0C000C0C00, 0x000C0C000C0408, // 8 9 : ;
    0x02040810080402, 0x00001F001F0000, 0x08040201020408, 0x0E110102040004, // < = > ?
    0x0E11171517100F, 0x040A11111F1111, 0x1E11111E11111E, 0x0F10101010100F, // @ A B C
    0x1E11111111111E, 0x1F10101E10101F, 0x1F10101E101010, 0x0F10101311110F, // D E F G
    0x1111111F111111, 0x0E04040404040E, 0x0701010101110E, 0x11121418141211, // H I J K
    0x1010101010101F, 0x111B1515111111, 0x11191515131311, 0x0E11111111110E, // L M N O
    0x1E11111E101010, 0x0E11111115120D, 0x1E11111E141211, 0x0F10100E01011E, // P Q R S
    0x1F040404040404, 0x1111111111110E, 0x11111111110A04, 0x1111111515150A, // T U V W
    0x11110A040A1111, 0x11110A04040404, 0x1F01020408101F, 0x0E08080808080E, // X Y Z [
    0x10100804020101, 0x0E02020202020E, 0x040A1100000000, 0x0000000000001F, // \ ] ^ _
    0x08040200000000, 0x00000E010F110F, 0x10101E1111111E, 0x00000F1010100F, // ` a b c
    0x01010F1111110F, 0x00000E111F100E, 0x0609081C080808, 0x0F11110F01010E, // d e f g
    0x10101E11111111, 0x04000C0404040E, 0x0200060202120C, 0x10101214181412, // h i j k
    0x0C04040404040E, 0x00001A15151511, 0x00001E11111111, 0x00000E1111110E, // l m n o
    0x1E11111E101010, 0x0F11110F010101, 0x00001619101010, 0x00000F100E011E, // p q r s
    0x08081C08080906, 0x0000111111110F, 0x000011110A0A04, 0x0000111515150A, // t u v w
    0x0000110A040A11, 0x1111110F01010E, 0x00001F0204081F, 0x02040408040402, // x y z {
    0x04040404040404, 0x08040402040408, 0x00000815020000};                  // | } ~

// Letters that hang below the line.
bool hangs(char letter) {
  return letter == 'g' || letter == 'j' || letter == 'p' || letter == 'q' || letter == 'y' ||
         letter == ',' || letter == ';';
}

bool continuesCharacter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0) == 0x80;
}

// What is drawn: one letter a character.
std::string asAscii(std::string_view text) {
  std::string ascii;
  for (const char byte : text)
    if (!continuesCharacter(byte))
      ascii += byte >= ' ' && byte <= '~' ? byte : '?';
  return ascii;
}

} // namespace

int textScale(int pictureHeight) {
  return std::max(1, (pictureHeight + 360) / 720);
}

int textWidth(std::string_view text, int scale) {
  const std::string ascii = asAscii(text);
  return ascii.empty() ? 0 : (static_cast<int>(ascii.size()) * kAdvance - 1) * scale;
}

int textHeight(int scale) {
  return (kHigh + kDrop) * scale;
}

int capitalHeight(int scale) {
  return kHigh * scale;
}

void drawText(Image& image, int x, int y, std::string_view text, const Pixel& color, int scale) {
  for (const char letter : asAscii(text)) {
    const std::uint64_t glyph = kGlyphs[static_cast<std::size_t>(letter - ' ')];
    const int drop = hangs(letter) ? kDrop * scale : 0;
    for (int row = 0; row < kHigh * scale; ++row)
      for (int column = 0; column < kWide * scale; ++column)
        if ((glyph >> (8 * (kHigh - 1 - row / scale) + kWide - 1 - column / scale) & 1) != 0)
          image.draw(x + column, y + drop + row, color);
    x += kAdvance * scale;
  }
}

std::string shortened(std::string_view text, int width, int scale) {
  std::string ascii = asAscii(text);
  const std::size_t room = static_cast<std::size_t>(std::max(0, width / scale + 1) / kAdvance);
  if (ascii.size() <= room)
    return ascii;
  if (room < 3)
    return ascii.substr(0, room);
  const std::size_t head = (room - 2) / 2, tail = room - 2 - head;
  return ascii.substr(0, head) + ".." + ascii.substr(ascii.size() - tail);
}

} // namespace tetvdb
