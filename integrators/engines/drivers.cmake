# Builds one driver program per physics engine whose package is found, build/engines/NAME. Copies the list of engines
# and the drivers for Node there. polhode does not need them: a missing engine is reported in its row of a table.
find_package(PkgConfig QUIET)
set(drivers ${PROJECT_SOURCE_DIR}/integrators/engines/drivers)
set(POLHODE_ENGINES_DIRECTORY ${PROJECT_BINARY_DIR}/engines)

add_library(polhode_engine_driver STATIC ${drivers}/serve.cpp ${drivers}/formula_loads.cpp)
target_link_libraries(polhode_engine_driver PUBLIC polhode polhode_flags nlohmann_json::nlohmann_json Eigen3::Eigen)
target_include_directories(polhode_engine_driver PUBLIC ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)
set(found "")
set(missing "")

# polhode_engine(NAME SOURCE [DEFINITIONS d..] [INCLUDES directory..] LIBRARIES library..)
function(polhode_engine name source)
  cmake_parse_arguments(PARSE_ARGV 2 engine "" "" "DEFINITIONS;INCLUDES;LIBRARIES")
  add_executable(polhode_engine_${name} ${drivers}/${source})
  set_target_properties(polhode_engine_${name} PROPERTIES OUTPUT_NAME ${name} UNITY_BUILD OFF
    RUNTIME_OUTPUT_DIRECTORY ${POLHODE_ENGINES_DIRECTORY})
  # no warnings from the engines' headers
  target_include_directories(polhode_engine_${name} SYSTEM PRIVATE ${engine_INCLUDES})
  target_compile_definitions(polhode_engine_${name} PRIVATE ${engine_DEFINITIONS})
  target_link_libraries(polhode_engine_${name} PRIVATE polhode_engine_driver ${engine_LIBRARIES})
  target_compile_options(polhode_engine_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  set(found ${found} ${name} PARENT_SCOPE)
endfunction()

# Debian's Bullet has libraries in both precisions
find_path(BULLET_INCLUDE btBulletDynamicsCommon.h PATH_SUFFIXES bullet)
set(parts BulletDynamics BulletCollision LinearMath)
foreach(precision IN ITEMS "" -float64)
  set(libraries "")
  foreach(part IN LISTS parts)
    find_library(BULLET_${part}${precision} NAMES ${part}${precision})
    list(APPEND libraries ${BULLET_${part}${precision}})
  endforeach()
  if(BULLET_INCLUDE AND NOT libraries MATCHES NOTFOUND)
    if(precision)
      polhode_engine(bullet bullet.cpp DEFINITIONS BT_USE_DOUBLE_PRECISION INCLUDES ${BULLET_INCLUDE} LIBRARIES ${libraries})
      polhode_engine(bullet_multibody bullet_multibody.cpp DEFINITIONS BT_USE_DOUBLE_PRECISION INCLUDES ${BULLET_INCLUDE}
        LIBRARIES ${libraries})
    else()
      polhode_engine(bullet_f32 bullet.cpp INCLUDES ${BULLET_INCLUDE} LIBRARIES ${libraries})
    endif()
  endif()
endforeach()

if(PKG_CONFIG_FOUND)
  pkg_check_modules(ODE QUIET IMPORTED_TARGET ode)
  if(ODE_FOUND)
    polhode_engine(ode ode.cpp DEFINITIONS POLHODE_ODE_VERSION="${ODE_VERSION}" LIBRARIES PkgConfig::ODE)
  endif()
  pkg_check_modules(SIMBODY QUIET IMPORTED_TARGET simbody)
  if(SIMBODY_FOUND)
    polhode_engine(simbody simbody.cpp LIBRARIES PkgConfig::SIMBODY)
    # Simbody's headers compile only as C++17
    target_sources(polhode_engine_simbody PRIVATE ${drivers}/simbody_world.cpp)
    set_source_files_properties(${drivers}/simbody_world.cpp PROPERTIES COMPILE_OPTIONS -std=c++17)
  endif()
endif()

find_path(MUJOCO_INCLUDE mujoco/mujoco.h)
find_library(MUJOCO_LIBRARY NAMES mujoco)
if(MUJOCO_INCLUDE AND MUJOCO_LIBRARY)
  polhode_engine(mujoco mujoco.cpp INCLUDES ${MUJOCO_INCLUDE} LIBRARIES ${MUJOCO_LIBRARY})
endif()

find_path(DART_INCLUDE dart/config.hpp)
find_library(DART_LIBRARY NAMES dart)
if(DART_INCLUDE AND DART_LIBRARY)
  polhode_engine(dart dart.cpp INCLUDES ${DART_INCLUDE} LIBRARIES ${DART_LIBRARY})
endif()

# copies the list of engines and the drivers for Node
set(copied "")
file(GLOB node_drivers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/integrators/engines/node/*.js
  ${PROJECT_SOURCE_DIR}/integrators/engines/node/*.json)
foreach(file IN LISTS node_drivers ITEMS ${PROJECT_SOURCE_DIR}/integrators/engines/engines.json)
  get_filename_component(name ${file} NAME)
  add_custom_command(OUTPUT ${POLHODE_ENGINES_DIRECTORY}/${name} DEPENDS ${file}
    COMMAND ${CMAKE_COMMAND} -E copy ${file} ${POLHODE_ENGINES_DIRECTORY}/${name})
  list(APPEND copied ${POLHODE_ENGINES_DIRECTORY}/${name})
endforeach()
list(TRANSFORM found PREPEND polhode_engine_ OUTPUT_VARIABLE programs)
add_custom_target(polhode_engine_programs ALL DEPENDS ${copied} ${programs})
message(STATUS "Engines found: ${found}")
