#pragma once

namespace rtusim {

/// A function of `librtusim_pictures.so`, which lies beside the program and brings OpenImageIO with it; loaded with the first call.
/// Errors: input_error when the library or the function is not there.
void* picture_function(const char* name);

}  // namespace rtusim
