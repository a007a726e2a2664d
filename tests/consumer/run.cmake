# Installs the build into a fresh folder, then configures, builds and runs the consumer against it.
#   cmake -DBUILD=... -DSOURCE=... -DWORK=... -DGENERATOR=... -DCXX=... -DTYPE=... -P run.cmake
file(REMOVE_RECURSE ${WORK})
function(must)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed: ${ARGV}")
  endif()
endfunction()
must(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
must(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${TYPE}
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${WORK}/prefix)
must(${CMAKE_COMMAND} --build ${WORK}/build)
must(${WORK}/build/consumer)
must(${WORK}/prefix/bin/tetvdb --version)

# The module that reads HDF5: where the installation puts it, and missing.
set(hdf5 ${SOURCE}/../data/readers/block.vtkhdf)
must(${WORK}/prefix/bin/tetvdb info ${hdf5})
must(${WORK}/build/consumer ${hdf5})
if(EXISTS ${WORK}/prefix/${LIBDIR}/tetvdb/tetvdb_formats.so)
  file(RENAME ${WORK}/prefix/${LIBDIR}/tetvdb/tetvdb_formats.so ${WORK}/tetvdb_formats.so)
  execute_process(COMMAND ${WORK}/prefix/bin/tetvdb info ${hdf5} RESULT_VARIABLE status ERROR_VARIABLE message)
  if(NOT status EQUAL 3 OR NOT message MATCHES "tetvdb_formats.so.*cannot be loaded.*install TetVDB again")
    message(FATAL_ERROR "without the module: status ${status}, ${message}")
  endif()
  file(RENAME ${WORK}/tetvdb_formats.so ${WORK}/prefix/${LIBDIR}/tetvdb/tetvdb_formats.so)
endif()

# The same object by the flags of pkg-config.
set(ENV{PKG_CONFIG_PATH} ${WORK}/prefix/${LIBDIR}/pkgconfig)
set(ENV{LD_LIBRARY_PATH} ${WORK}/prefix/${LIBDIR}:$ENV{LD_LIBRARY_PATH})
must(pkg-config --cflags tetvdb)
must(sh -c "${CXX} build/CMakeFiles/consumer.dir/main.cpp.o $(pkg-config --libs tetvdb) -o by_pkg_config"
  WORKING_DIRECTORY ${WORK})
must(${WORK}/by_pkg_config)
must(${WORK}/by_pkg_config ${hdf5})
