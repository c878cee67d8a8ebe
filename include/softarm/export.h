// What other packages may link to.
#pragma once

/// Symbols of libsoftarm_core.so are hidden unless declared with this: it stands before a function, and
/// between `class` or `struct` and the name of a type that has functions in the library or is thrown.
#define SOFTARM_EXPORT __attribute__((visibility("default")))
