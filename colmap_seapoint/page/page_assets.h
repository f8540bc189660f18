// The files of web/, built in (embed_assets.cmake). UTF-8.
#pragma once

namespace colmap_seapoint {

extern const char kPageTemplate[];  // with {{names}} of what comes in (html_page.cc)
extern const char kPageStyle[];
extern const char kPageScript[];
extern const char kThreeScript[];  // three.js, an ES module
extern const char kThreeLicence[];

}  // namespace colmap_seapoint
