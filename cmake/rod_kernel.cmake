# The rod's inner loops are compiled once per instruction set and picked at run time (src/rod/kernel/pick.cpp). These files
# use no library, so that no inline function of another one is compiled with instructions a processor may lack.
file(GLOB ROD_KERNEL_SOURCES CONFIGURE_DEPENDS src/rod/kernel/*.cpp)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set_source_files_properties(src/rod/kernel/avx2.cpp PROPERTIES COMPILE_OPTIONS "-mavx2;-mfma")
  set_source_files_properties(src/rod/kernel/avx512.cpp PROPERTIES
    COMPILE_OPTIONS "-mavx512f;-mavx512dq;-mfma;-mprefer-vector-width=512")
endif()
# Vectors of 8 doubles never cross a library boundary by value, so their calling convention does not matter.
set_source_files_properties(${ROD_KERNEL_SOURCES} PROPERTIES COMPILE_FLAGS "-Wno-psabi")
# No header of a library in them, precompiled or not, and each on its own.
set_source_files_properties(${ROD_KERNEL_SOURCES} PROPERTIES SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
