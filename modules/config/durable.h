#pragma once

#include <filesystem>
#include <string_view>

namespace rtusim::config {

/// Waits until a folder's names are on the disk: of files that were made in it, renamed into it or removed from it. Not what they hold.
/// Errors: input_error when it is not there or the disk fails.
void sync_folder(const std::filesystem::path& folder);

/// Waits until all that was written so far, by anybody, to the file system that holds `place` is on the disk: files and names. For many
/// files this is quicker than each by itself.
/// Errors: as `sync_folder`.
void sync_file_system(const std::filesystem::path& place);

/// Writes a file that is not there yet; what lies under its name, be it a link that leads nowhere, is left as it is. It is not synced.
/// Errors: input_error when something is there, the folder is missing or can't be written, or the disk is full; then no file is left.
void write_new_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace rtusim::config
