# Removes the files of the last installation of a build, and the directories of polhode that are then empty.
#
#   cmake -DMANIFEST=build/install_manifest.txt -P uninstall.cmake
cmake_minimum_required(VERSION 3.22)

if(NOT EXISTS ${MANIFEST})
  message(FATAL_ERROR "${MANIFEST}: does not exist; this build was not installed")
endif()
file(STRINGS ${MANIFEST} files)
foreach(file IN LISTS files)
  set(path $ENV{DESTDIR}${file})
  file(REMOVE ${path})
  get_filename_component(folder ${path} DIRECTORY)
  # only directories named after the program, and their subdirectories
  while(folder MATCHES "polhode")
    file(GLOB left ${folder}/* ${folder}/.*)
    if(left)
      break()
    endif()
    file(REMOVE_RECURSE ${folder})
    get_filename_component(folder ${folder} DIRECTORY)
  endwhile()
endforeach()
list(LENGTH files count)
message(STATUS "removed ${count} files")
