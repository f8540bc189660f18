// Bytes as text: pictures and points inside of a page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace colmap_seapoint {

// RFC 4648, with padding, in one line.
std::string Base64(const uint8_t* bytes, size_t size);

// "data:<type>;base64,...", for the src of a picture.
std::string DataUri(const std::string& type, const uint8_t* bytes, size_t size);

}  // namespace colmap_seapoint
