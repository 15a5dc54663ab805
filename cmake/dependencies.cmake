# Every library the project uses, found in one place.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc calib3d aruco)
find_package(TBB REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(embree 3 REQUIRED)
find_package(Ceres 2.1 REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(JPEG REQUIRED)
find_package(PNG REQUIRED)
find_package(TIFF REQUIRED)
find_package(ZLIB REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tl-expected REQUIRED)
pkg_check_modules(lcms2 REQUIRED IMPORTED_TARGET lcms2)
pkg_check_modules(serialport REQUIRED IMPORTED_TARGET libserialport)
# Its .pc file needs that of libusb, which its package does not bring.
pkg_check_modules(aravis REQUIRED IMPORTED_TARGET aravis-0.8)

# mrcal ships neither a .pc nor a CMake file.
find_path(MRCAL_INCLUDE_DIR mrcal/mrcal.h REQUIRED)
find_library(MRCAL_LIBRARY mrcal REQUIRED)
add_library(mrcal::mrcal UNKNOWN IMPORTED)
set_target_properties(mrcal::mrcal PROPERTIES
  IMPORTED_LOCATION ${MRCAL_LIBRARY}
  INTERFACE_INCLUDE_DIRECTORIES ${MRCAL_INCLUDE_DIR})

# Nor do mrgingham and, in Debian, CHOLMOD.
find_path(MRGINGHAM_INCLUDE_DIR mrgingham/mrgingham.hh REQUIRED)
find_library(MRGINGHAM_LIBRARY mrgingham REQUIRED)
add_library(mrgingham::mrgingham UNKNOWN IMPORTED)
set_target_properties(mrgingham::mrgingham PROPERTIES
  IMPORTED_LOCATION ${MRGINGHAM_LIBRARY}
  INTERFACE_INCLUDE_DIRECTORIES ${MRGINGHAM_INCLUDE_DIR})
find_path(CHOLMOD_INCLUDE_DIR suitesparse/cholmod.h REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
add_library(SuiteSparse::cholmod UNKNOWN IMPORTED)
set_target_properties(SuiteSparse::cholmod PROPERTIES
  IMPORTED_LOCATION ${CHOLMOD_LIBRARY}
  INTERFACE_INCLUDE_DIRECTORIES ${CHOLMOD_INCLUDE_DIR})

# These two come as plain variables; as targets their headers are "system" and their warnings not ours.
add_library(turnlight_opencv INTERFACE)
target_include_directories(turnlight_opencv SYSTEM INTERFACE ${OpenCV_INCLUDE_DIRS})
target_link_libraries(turnlight_opencv INTERFACE opencv_core opencv_imgproc)
# What only the calibration needs: chessboards, poses of boards, ChArUco and AprilTag.
add_library(turnlight_opencv_boards INTERFACE)
target_link_libraries(turnlight_opencv_boards INTERFACE turnlight_opencv opencv_calib3d opencv_aruco)
add_library(turnlight_yaml INTERFACE)
target_include_directories(turnlight_yaml SYSTEM INTERFACE ${YAML_CPP_INCLUDE_DIR})
target_link_libraries(turnlight_yaml INTERFACE ${YAML_CPP_LIBRARIES})
