#pragma once

// Blur of what is out of focus, in images.
//
// Based on: Potmesil, Chakravarty. A Lens and Aperture Camera Model for Synthetic Image Generation. 1981.
// Rokita. Fast Generation of Depth of Field Effects in Computer Graphics. 1993. Snyder, Lengyel.
// MSR-TR-97-11, 1997, section 10.
//
// All blurs here: beyond its borders a picture is taken to go on as its outermost pixels do, so that an even
// picture stays even. Away from the borders the sums of colour and of opacity are kept. Pixels that are not
// finite count as transparent. Where the whole image is left as it is, they stay too. `blurred` must not be
// `image`; it gets no depths, and keeps its memory. What is transparent costs nothing but its memory.
// Pixels are taken to be square: of a view whose aspect is not the picture's, discs would have to be
// ellipses. Preconditions: width * height pixels; depths none or as many. Safe to call from several threads.

#include <cstdint>
#include <vector>

#include "sightline/render/layer_image.h"
#include "sightline/scene/camera.h"

namespace sightline {

// Thin, as pictures are drawn through it by LayerRenderer (LensPoint): a point at distance z of a perspective
// view is spread to a disc of diameter aperture * |z - focus| / z on the plane of focus. 0 or not a number:
// a pinhole.
struct Lens {
  double focus = 10.0;     // metres along forward to what is sharp, > 0
  double aperture = 0.05;  // metres, its diameter
};

// Diameter of the circle of confusion, pixels of a picture of this height. In orthographic views it is
// aperture * |z - focus| / focus metres on the plane of focus. depth: metres along forward;
// LayerImage::kNoDepth: at infinity (infinite in orthographic views). 0 for a depth that is none: not a
// number, or of a perspective view not positive.
double circleOfConfusion(const View& view, const Lens& lens, double depth, std::uint32_t height);

// Spread evenly over a disc, colour and opacity; fractional diameters change smoothly; up to 1 pixel: as it
// is. Larger than width + height: as that. The disc's chords are averaged over each row of pixels, and their
// ends cover pixels in part. Time: a pixel's, times the diameter.
void blurEvenly(const LayerImage& image, double diameter, LayerImage& blurred);

// Each pixel spread over its own disc, by image.depths, as blurEvenly spreads it; without depths as it is.
// Normalised: colour and opacity divided by the sum of opacity that arrives, so that everything reached is
// opaque (Potmesil). As it arrives: opacity is below 1 where less arrives, and above where more does
// (Rokita).
enum class Spread : std::uint8_t { kNormalised, kAsItArrives };
void blurByDepth(const LayerImage& image, const View& view, const Lens& lens, Spread spread,
                 LayerImage& blurred);

// Points of a disc of diameter 1 around 0, each for as much of its area, symmetric about 0; the accumulation
// buffer's passes. Two arms of a Fermat spiral; a point in the middle where count is odd.
struct DiscPoint {
  double x = 0.0, y = 0.0;
};
std::vector<DiscPoint> discPoints(std::uint32_t count);

// Spread evenly along a line of pixels (x right, y down) centred at each pixel: motion blur of a layer that
// moves as a whole. Changes smoothly with the line; not finite: as it is; longer than width + height: as long
// as that. Time: a pixel's, times the length.
void blurAlong(const LayerImage& image, double dx, double dy, LayerImage& blurred);

}  // namespace sightline
