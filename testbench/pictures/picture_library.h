#pragma once

namespace rtusim {

/// A function of `librtusim_pictures.so`, which brings OpenImageIO with it; loaded with the first call. It lies beside the program, where
/// the build leaves it, or in ../lib/rtusim, where it is installed.
/// Errors: input_error when the library or the function is not there.
void* picture_function(const char* name);

/// Loads the library, and calls nothing in it, so that processes that are forked afterwards find it there. Where it can't be loaded it is
/// theirs to say so.
void share_picture_library() noexcept;

}  // namespace rtusim
