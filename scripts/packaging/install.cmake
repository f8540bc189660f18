# cmake --install and cpack: the program with its man page and completion, and the libraries with
# their headers for find_package(colmap_seapoint). Two components, two Debian packages.
include(CMakePackageConfigHelpers)

set(package_doc_dir ${CMAKE_INSTALL_DATADIR}/doc/colmap-seapoint)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/colmap_seapoint)

# --- program -------------------------------------------------------------------------------------
install(TARGETS colmap_seapoint RUNTIME COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  DESTINATION ${package_doc_dir} COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/colmap_seapoint/README.md
  ${PROJECT_SOURCE_DIR}/colmap_seapoint/OPTIONS.md
  DESTINATION ${package_doc_dir}/colmap_seapoint COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION ${package_doc_dir} RENAME copyright COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/colmap_seapoint/page/web/three/LICENSE
  DESTINATION ${package_doc_dir} RENAME copyright.three.js COMPONENT program)

# The program itself writes them, from its option tables. Not where it cannot, or need not, run.
if(NOT CMAKE_CROSSCOMPILING AND NOT SEAPOINT_SANITIZE)
  set(manual_dir ${CMAKE_BINARY_DIR}/manual)
  add_custom_command(
    OUTPUT ${manual_dir}/colmap_seapoint.1 ${manual_dir}/completions/colmap_seapoint
    COMMAND ${CMAKE_COMMAND} -E make_directory ${manual_dir}/completions
    COMMAND $<TARGET_FILE:colmap_seapoint> help --format man > ${manual_dir}/colmap_seapoint.1
    COMMAND $<TARGET_FILE:colmap_seapoint> help --format bash > ${manual_dir}/completions/colmap_seapoint
    DEPENDS colmap_seapoint
    COMMENT "Man page and bash completion"
    VERBATIM)
  add_custom_target(manual ALL
    DEPENDS ${manual_dir}/colmap_seapoint.1 ${manual_dir}/completions/colmap_seapoint)
  install(FILES ${manual_dir}/colmap_seapoint.1
    DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${manual_dir}/completions/colmap_seapoint
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
endif()

# --- libraries -----------------------------------------------------------------------------------
# What an outsider links: feature, densify, colmap, cloud, pipeline. The other targets come along;
# only the headers that a room names as its public ones do.
set(exported_targets
  seapoint_flags seapoint_simd seapoint_base seapoint_system
  seapoint_files seapoint_nav_files seapoint_outputs seapoint_image seapoint_video seapoint_cloud
  seapoint_las seapoint_colmap seapoint_pdf seapoint_gis seapoint_raster seapoint_water seapoint_io
  seapoint_feature_kernels seapoint_feature_detector seapoint_feature_descriptor
  seapoint_feature_matching seapoint_feature_retrieval seapoint_feature_remeasuring seapoint_feature
  seapoint_densify_kernels seapoint_densify_match seapoint_densify_overlap seapoint_densify_cloud
  seapoint_densify_sequence seapoint_densify_maps seapoint_densify_completeness
  seapoint_densify_self_check seapoint_densify
  seapoint_estimate seapoint_markers seapoint_georeference seapoint_navigation seapoint_compare
  seapoint_map_ground seapoint_map_relief seapoint_map_sources seapoint_orthomosaic
  seapoint_tracks seapoint_adjustment seapoint_lens seapoint_reposing seapoint_remeasuring
  seapoint_mapping seapoint_cameras seapoint_pictures seapoint_frames seapoint_joining seapoint_pairing
  seapoint_workspace seapoint_disk seapoint_gaps seapoint_page seapoint_intake seapoint_report
  seapoint_pipeline_completeness seapoint_pipeline_orthomosaic seapoint_pipeline_page
  seapoint_pipeline)
foreach(target IN LISTS exported_targets)
  string(REPLACE seapoint_ "" name ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
endforeach()
# Below a folder of ours: "feature/..." is no name for /usr/include.
install(TARGETS ${exported_targets} EXPORT colmap_seapoint_targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/colmap_seapoint COMPONENT development)
install(EXPORT colmap_seapoint_targets NAMESPACE colmap_seapoint::
  FILE colmap_seapointTargets.cmake DESTINATION ${config_dir} COMPONENT development)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/colmap_seapointConfig.cmake.in
  ${CMAKE_BINARY_DIR}/colmap_seapointConfig.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/colmap_seapointConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/colmap_seapointConfig.cmake
  ${CMAKE_BINARY_DIR}/colmap_seapointConfigVersion.cmake
  DESTINATION ${config_dir} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/library_users
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libcolmap-seapoint-dev/examples COMPONENT development)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libcolmap-seapoint-dev RENAME copyright
  COMPONENT development)

# --- Debian packages: scripts/make_deb.sh --------------------------------------------------------
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME colmap-seapoint)
set(CPACK_PACKAGE_VENDOR "the colmap_seapoint authors")
set(CPACK_PACKAGE_CONTACT "the colmap_seapoint authors <colmap-seapoint@localhost>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
  "dense point clouds from underwater pictures
SeaPoints are found in any water, poses come from the unmodified COLMAP, and
then only what is new is densified, pair by pair along the track.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME colmap-seapoint)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Only automatic_reconstructor calls it, and it may be another build of COLMAP (--colmap_path).
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "colmap (>= 3.8)")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
  "dense point clouds from underwater pictures: libraries
Static libraries, headers and CMake targets: colmap_seapoint::feature finds
and matches SeaPoints, colmap_seapoint::densify makes clouds, ::colmap and
::cloud read and write COLMAP's models and PLY, ::pipeline is the whole chain.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libcolmap-seapoint-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libeigen3-dev, libopencv-dev (>= 4.5), libceres-dev (>= 2.0), libhwy-dev (>= 1.0.3), pkg-config, \
libsqlite3-dev, libproj-dev, libgdal-dev, libxxhash-dev, libjpeg-dev, libpng-dev, libtiff-dev, libwebp-dev, \
libheif-dev, libraw-dev, libavformat-dev, libavcodec-dev, libavutil-dev, libswscale-dev, libexiv2-dev, \
liblensfun-dev, libapriltag-dev, libhpdf-dev")
include(CPack)
