# Source files that include OpenVDB, directly or through other headers, are compiled apart from those
# that do not: its headers take longer to compile than most files. With CMAKE_UNITY_BUILD, files of a
# folder are compiled together: about 8 at a time, about 16 of those with OpenVDB, whose templates
# they share. Which files meet follows from their names, so that a new file leaves the others where
# they are.

# Precompiled: in most files these are more text than the file itself. <filesystem> is not among them, since its
# std::quoted() would be found where ours is meant.
set(precompiled_headers <algorithm> <array> <cmath> <cstdint> <cstring> <functional> <limits> <map> <memory>
  <numeric> <optional> <set> <string> <string_view> <utility> <vector>
  <fmt/format.h> <tbb/blocked_range.h> <tbb/parallel_for.h> <tbb/task_arena.h>)

# Those of some files that include OpenVDB, or one of `headers`.
function(find_users result headers)
  list(JOIN headers "|" names)
  set(users)
  foreach(file IN LISTS ARGN)
    file(STRINGS ${file} lines LIMIT_COUNT 1 REGEX "^#include (<openvdb/|\"(${names})\")")
    if(lines)
      list(APPEND users ${file})
    endif()
  endforeach()
  set(${result} ${users} PARENT_SCOPE)
endfunction()

# Those sources of the library in `lib` that include OpenVDB.
function(find_openvdb_users result lib)
  file(GLOB_RECURSE headers ${lib}/*.h)
  set(openvdb_headers none)
  set(users none)
  while(users)
    find_users(users "${openvdb_headers}" ${headers})
    if(users)
      list(REMOVE_ITEM headers ${users})
      list(TRANSFORM users REPLACE "^${lib}/(include/)?" "")
      list(APPEND openvdb_headers ${users})
    endif()
  endwhile()
  find_users(users "${openvdb_headers}" ${ARGN})
  set(${result} ${users} PARENT_SCOPE)
endfunction()

# Groups sources of the library in `lib`, `size` at a time, in the CMake folder that calls this.
# `name`: of the groups, besides the folder's.
function(set_unity_groups name size lib)
  set(groups)
  foreach(source IN LISTS ARGN)
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH group ${lib}/tetvdb ${folder})
    string(REPLACE "/" "_" group ${group}${name})
    list(APPEND groups ${group})
    list(APPEND sources_of_${group} ${source})
  endforeach()
  list(REMOVE_DUPLICATES groups)
  foreach(group IN LISTS groups)
    list(LENGTH sources_of_${group} count)
    foreach(source IN LISTS sources_of_${group})
      get_filename_component(file ${source} NAME)
      string(MD5 hash ${file})
      string(SUBSTRING ${hash} 0 4 hash)
      math(EXPR part "0x${hash} % ((${count} + ${size} - 1) / ${size})")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group}_${part})
    endforeach()
  endforeach()
endfunction()
