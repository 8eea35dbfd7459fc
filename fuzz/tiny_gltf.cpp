// tinygltf compiled with the sanitizers, in place of the distribution's library.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
