// A row of the catalogue built from TOML as a scene writes it, or what it says of why not.
#pragma once

#include "terrain/shape.h"

#include <memory>
#include <string>

namespace hoodoo::testing
{

/// The error's text without its excerpt, or "". `built` gets the shape; `base` is what every name of another terrain means.
std::string error_of_row(const std::string& name, const std::string& text, std::unique_ptr<Shape>* built = nullptr,
                         std::shared_ptr<const Surface> base = nullptr);

}  // namespace hoodoo::testing
