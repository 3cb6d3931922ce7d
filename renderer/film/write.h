// Pictures to files and back: EXR for all that is known, PNG for the eye.
#pragma once

#include "renderer/film/color.h"
#include "renderer/film/image.h"

#include <string>

namespace hoodoo
{

/// standard: half floats where eleven bits are enough for the eye and for compositing. full: floats everywhere, for references of measurements.
enum class ExrPrecision { standard, full };

/// Writes all channels and the metadata into a single-part OpenEXR file, zip compressed; the data window inside the display window, row 0 on top.
/// At standard precision R, G, B, A, N.*, Ng.*, albedo.*, material.* are half floats, everything else floats (ids too: exact below 2^24). R, G, B
/// become floats where a half would overflow (a visible sun). Metadata: 2, 3, 16 numbers become a vector or a matrix, the 8 of `chromaticities` that
/// attribute, and `DateTime` (YYYY:MM:DD HH:MM:SS) the standard capDate. Equal images make equal bytes. Atomic and verified; throws Error (file).
void write_exr(const Image& image, const std::string& path, ExrPrecision precision = ExrPrecision::standard);

/// Reads a single-part EXR: every channel as floats, in the order of the file (sorted by name), and the metadata of the kinds that write_exr knows.
/// Throws Error (file).
Image read_exr(const std::string& path);

/// The data window's R, G, B as a screen shows them, row by row: times 2^exposure, through `to_display`, clamped to [0, 1], rounded to eight bits.
/// Throws Error (file) at a pixel that is not finite.
std::vector<std::uint8_t> display_bytes(const Image& image, const ColorTransform& to_display, double exposure_stops);

/// Writes the data window's R, G, B as eight-bit PNG, as display_bytes has them. `is_srgb`
/// marks the file as sRGB. Alpha is left out, so that the sky stays visible. Atomic and verified; throws Error (file), also where a pixel is not
/// finite.
/// Keeps hoodoo:picture of the metadata as a text.
void write_png(const Image& image, const std::string& path, const ColorTransform& to_display, double exposure_stops, bool is_srgb);

/// Decodes all of a PNG and returns the text of that name, "" if it has none. Throws Error (file).
std::string read_png_text(const std::string& path, const std::string& name);

}  // namespace hoodoo
