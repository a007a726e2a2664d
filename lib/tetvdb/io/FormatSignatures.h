// SPDX-License-Identifier: Apache-2.0
//
// Recognition of formats by a file's content; the table io/Formats.h calls these functions.
#pragma once

#include <string>
#include <string_view>

namespace tetvdb {

/// The beginning of a file, for the signatures.
struct FileStart {
  FileStart(std::string_view bytes, const std::string& path);

  std::string_view bytes; ///< the whole file
  std::string_view head;  ///< its first 4096 bytes
  std::string_view text;  ///< `head` without a byte order mark and white space before the text
  std::string start;      ///< the first 32 characters of `text` in lower case
  std::string ending;     ///< ".vtu" in lower case
};

bool isVdb(const FileStart& file);
bool isNvdb(const FileStart& file);
bool isNpy(const FileStart& file);
bool isNpz(const FileStart& file);
bool isVtkImage(const FileStart& file);
bool isVti(const FileStart& file);
bool isNhdr(const FileStart& file);
bool isNrrd(const FileStart& file);
bool isHdf5(const FileStart& file);
bool isMetaImage(const FileStart& file);
bool isNifti(const FileStart& file);
bool isTiff(const FileStart& file);
bool isBinvox(const FileStart& file);

bool isStl(const FileStart& file);
bool isObj(const FileStart& file);
bool isOff(const FileStart& file);
bool isPly(const FileStart& file);
bool isThreeMf(const FileStart& file);
bool isAmf(const FileStart& file);
bool isGltf(const FileStart& file);
bool isFbx(const FileStart& file);
bool isCollada(const FileStart& file);
bool isThreeDs(const FileStart& file);

bool isGmsh(const FileStart& file);
bool isMedit(const FileStart& file);
bool isMeditBinary(const FileStart& file);
bool isNetgen(const FileStart& file);
bool isAbaqus(const FileStart& file);
bool isNastran(const FileStart& file);
bool isUcd(const FileStart& file);
bool isVtk(const FileStart& file);
bool isVtu(const FileStart& file);
bool isVts(const FileStart& file);
bool isPvtu(const FileStart& file);
bool isVtp(const FileStart& file);
bool isVtm(const FileStart& file);
bool isPvd(const FileStart& file);
bool isVtkHdf(const FileStart& file);
bool isCgns(const FileStart& file);
bool isEnsight(const FileStart& file);
bool isFrd(const FileStart& file);
bool isNeu(const FileStart& file);
bool isSu2(const FileStart& file);
bool isOpenFoam(const FileStart& file);
bool isUnv(const FileStart& file);
bool isXdmf(const FileStart& file);
bool isExodus(const FileStart& file);

// For names with the format's ending: content that is damaged after its first words.
bool isAny(const FileStart& file);
bool isDamagedGmsh(const FileStart& file);
bool isDamagedMedit(const FileStart& file);
bool isDamagedNetgen(const FileStart& file);
bool isDamagedAbaqus(const FileStart& file);
bool isDamagedNastran(const FileStart& file);

/// Whether `head` has only characters of texts.
bool isText(std::string_view head);

} // namespace tetvdb
