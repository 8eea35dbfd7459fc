#pragma once

namespace sightline::tool {

// Colours of the pictures of trees and of what they hide.
inline constexpr const char* kInk = "#333333";     // text, nodes, the eye
inline constexpr const char* kDimInk = "#8a8f98";  // the view's borders
inline constexpr const char* kOccluderInk = "#143cbe";
inline constexpr const char* kPlaneInk = "#c47a12";    // shadow planes
inline constexpr const char* kFlaggedInk = "#c0392b";  // planes that repeat another; the tested box
inline constexpr const char* kWallInk = "#b9bdc4";     // potential occluders, nodes that were not reached
inline constexpr const char* kInView = "#f4f5f8";
inline constexpr const char* kInShadow = "#a9b4c6";
inline constexpr const char* kMarked = "#f4d35e";
inline constexpr const char* kHiddenNode = "#5b6270";
inline constexpr const char* kPartialNode = "#c9cfdb";
inline constexpr const char* kVisibleNode = "#8fcf7a";

}  // namespace sightline::tool
