# Removes what the last installation of a build put in place, and the folders that are empty then.
#
#   cmake -DMANIFEST=build/install_manifest.txt -P uninstall.cmake
cmake_minimum_required(VERSION 3.22)

if(NOT EXISTS ${MANIFEST})
  message(FATAL_ERROR "${MANIFEST}: there is none, so nothing was installed from here")
endif()
file(STRINGS ${MANIFEST} files)
foreach(file IN LISTS files)
  set(path $ENV{DESTDIR}${file})
  file(REMOVE ${path})
  get_filename_component(folder ${path} DIRECTORY)
  # folders of our own alone: those named after the program, and what lies in them
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
