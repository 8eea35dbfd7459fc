#pragma once

// Blurs images by how far their pixels are out of focus.
//
// Based on: Potmesil, Chakravarty. A Lens and Aperture Camera Model for Synthetic Image Generation. 1981.
// Rokita. Fast Generation of Depth of Field Effects in Computer Graphics. 1993. Snyder, Lengyel.
// MSR-TR-97-11, 1997, section 10.
//
// All blurs continue a picture beyond its borders by its outermost pixels, so that an even picture stays
// even. Away from the borders they keep the sums of colour and of opacity. Pixels that are not finite count
// as transparent; if a blur leaves the image as it is, they are copied too. `blurred` must not be `image`; it
// gets no depths and reuses its memory. Transparent pixels cost no time. Pixels are taken to be square: if a
// view's aspect differed from the picture's, discs would have to be ellipses. Preconditions: width * height
// pixels, and as many depths or none. Safe to call from several threads.

#include <cstdint>
#include <vector>

#include "sightline/render/layer_image.h"
#include "sightline/scene/camera.h"

namespace sightline {

// A thin lens, as LayerRenderer draws through it (LensPoint). In a perspective view a point at distance z
// becomes a disc of diameter aperture * |z - focus| / z on the plane of focus. An aperture of 0 or NaN is a
// pinhole.
struct Lens {
  double focus = 10.0;     // metres along forward to the plane of focus, > 0
  double aperture = 0.05;  // diameter in metres
};

// The diameter of the circle of confusion in pixels, for a picture of `height` pixels. In orthographic views
// it is aperture * |z - focus| / focus metres on the plane of focus. depth is in metres along forward;
// LayerImage::kNoDepth stands for infinity (the circle is then infinite in orthographic views). 0 for NaN,
// and in perspective views for a depth <= 0.
double circleOfConfusion(const View& view, const Lens& lens, double depth, std::uint32_t height);

// Spreads each pixel's colour and opacity evenly over a disc. The diameter is in pixels; the result changes
// smoothly with it. Up to 1 the image is copied, above width + height it is clamped. The disc's chords are
// averaged over each row of pixels and cover pixels at their ends in part. Takes time proportional to pixels
// times diameter.
void blurEvenly(const LayerImage& image, double diameter, LayerImage& blurred);

// Spreads each pixel over a disc of its own, sized by image.depths, as blurEvenly does; an image without
// depths is copied. kNormalised divides colour and opacity by the opacity that arrives, so that every pixel
// reached is opaque (Potmesil). kAsItArrives leaves opacity below 1 where less arrives and above 1 where more
// does (Rokita).
enum class Spread : std::uint8_t { kNormalised, kAsItArrives };
void blurByDepth(const LayerImage& image, const View& view, const Lens& lens, Spread spread,
                 LayerImage& blurred);

// Points of a disc of diameter 1 around 0 that share its area evenly, for the passes of an accumulation
// buffer. Symmetric about 0: two arms of a Fermat spiral, and a point in the middle if count is odd.
struct DiscPoint {
  double x = 0.0, y = 0.0;
};
std::vector<DiscPoint> discPoints(std::uint32_t count);

// Spreads each pixel evenly along the line (dx, dy), in pixels (x right, y down), centred at the pixel: the
// motion blur of a layer that moves as a whole. The result changes smoothly with the line. If the line is not
// finite the image is copied; a line longer than width + height is shortened to that. Takes time proportional
// to pixels times length.
void blurAlong(const LayerImage& image, double dx, double dy, LayerImage& blurred);

}  // namespace sightline
