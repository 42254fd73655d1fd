# cmake -D BUILD=... -D COMPILER=... -P check.cmake: installs the build into a folder of its own, and builds and runs a
# project that finds it there.
set(prefix ${BUILD}/tests/package/prefix)
set(consumer ${BUILD}/tests/package/consumer)
file(REMOVE_RECURSE ${prefix} ${consumer})
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${consumer} -G Ninja -D CMAKE_PREFIX_PATH=${prefix}
    -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${consumer})
run(${consumer}/fall)
run(${consumer}/listen)
run(${prefix}/bin/tumble-server --version)
run(${prefix}/bin/tumble --version)
