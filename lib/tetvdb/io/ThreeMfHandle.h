// SPDX-License-Identifier: Apache-2.0
//
// Objects of lib3mf's C interface.
#pragma once

#include <Model/COM/NMR_DLLInterfaces.h>
#include <string>

namespace tetvdb {

/// Releases what lib3mf gave. Not copyable.
class ThreeMfHandle {
public:
  ThreeMfHandle() = default;
  ~ThreeMfHandle() {
    if (object_ != nullptr)
      NMR::lib3mf_release(object_);
  }
  ThreeMfHandle(const ThreeMfHandle&) = delete;
  ThreeMfHandle& operator=(const ThreeMfHandle&) = delete;

  /// Where a function of lib3mf puts an object; of an empty handle only.
  NMR::PLib3MFBase** put() { return &object_; }
  operator NMR::PLib3MFBase*() const { return object_; }

  /// What lib3mf says of the last call on the object, as a part of a sentence.
  std::string lastError() const {
    DWORD code = 0;
    LPCSTR text = nullptr;
    if (object_ == nullptr || NMR::lib3mf_getlasterror(object_, &code, &text) != 0 ||
        text == nullptr || *text == '\0')
      return "lib3mf gives no reason";
    std::string line;
    for (const char* c = text; *c != '\0' && line.size() < 200; ++c)
      line += *c < ' ' || *c > '~' ? ' ' : *c;
    return line + " (lib3mf error " + std::to_string(code) + ")";
  }

private:
  NMR::PLib3MFBase* object_ = nullptr;
};

} // namespace tetvdb
