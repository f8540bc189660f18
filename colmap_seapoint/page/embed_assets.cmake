# Writes the files of the page as constants of a C++ source.
#   cmake -DTEMPLATE=... -DSTYLES=a;b -DSCRIPTS=a;b -DTHREE=... -DTHREE_LICENCE=... -DOUTPUT=FILE -P this
#
# A raw string ends at its own mark alone, so that any text can be one; a file with the mark in it
# ends the build.
set(mark seapoint)
set(source "#include \"colmap_seapoint/page/page_assets.h\"\n\nnamespace colmap_seapoint {\n")

function(add_constant name)  # FILE...
  set(text "")
  foreach(file IN LISTS ARGN)
    file(READ "${file}" content)
    string(FIND "${content}" ")${mark}\"" found)
    if(NOT found EQUAL -1)
      message(FATAL_ERROR "${file} holds the mark that ends a constant; choose another one here")
    endif()
    string(APPEND text "${content}")
  endforeach()
  set(source "${source}\nconst char ${name}[] = R\"${mark}(${text})${mark}\";\n" PARENT_SCOPE)
endfunction()

add_constant(kPageTemplate "${TEMPLATE}")
add_constant(kPageStyle ${STYLES})
add_constant(kPageScript ${SCRIPTS})
add_constant(kThreeScript "${THREE}")
add_constant(kThreeLicence "${THREE_LICENCE}")
file(WRITE "${OUTPUT}" "${source}\n}  // namespace colmap_seapoint\n")
