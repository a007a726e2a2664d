// SPDX-License-Identifier: Apache-2.0
//
// Adapters to std::streambuf, for libraries that write to streams. Internal.
#pragma once

#include <cstddef>
#include <streambuf>
#include <string>
#include <string_view>

namespace tetvdb {

/// Passes output to `sink.write(data, size)`, unbuffered. Exceptions pass through the stream if its
/// exception mask has badbit.
template <class Sink>
class SinkBuffer : public std::streambuf {
public:
  explicit SinkBuffer(Sink& sink) : sink_(sink) {}

protected:
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    sink_.write(data, static_cast<std::size_t>(size));
    written_ += size;
    return size;
  }
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof()))
      return traits_type::not_eof(c);
    const char byte = traits_type::to_char_type(c);
    xsputn(&byte, 1);
    return c;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const bool tells = offset == 0 && from == std::ios_base::cur;
    return tells ? pos_type(written_) : pos_type(off_type(-1));
  }

private:
  Sink& sink_;
  off_type written_ = 0;
};

/// Bytes in memory, to be read.
class ByteSource : public std::streambuf {
public:
  explicit ByteSource(std::string_view bytes) {
    char* begin = const_cast<char*>(bytes.data());
    setg(begin, begin, begin + bytes.size());
  }
};

/// Bytes in memory, as a sink.
struct ByteSink {
  std::string bytes;
  void write(const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  }
};

} // namespace tetvdb
