#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "modules/config/schema.h"
#include "scenes/rays/camera.h"
#include "scenes/rays/raster.h"

namespace rtusim {

/// What is traced and from where: a scene file.
struct scene {
  struct model_params {
    std::string model;
    std::string rays;
    unsigned resolution = 32;
    unsigned patch_quads = 10;
    void describe(config::section& s);
  };

  model_params model;
  raster picture;
  camera::params view;

  void describe(config::schema& s);
  /// The kind of file that these sections stand in.
  static constexpr std::string_view home = "a scene file";
};

/// Whether the file's name is that of a model of any kind.
bool is_model(const std::filesystem::path& file);

}  // namespace rtusim
