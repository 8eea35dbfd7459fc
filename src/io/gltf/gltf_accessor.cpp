#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "src/io/gltf/gltf_model.h"

namespace sightline::io {
namespace {

template <typename T>
T readAs(const char* bytes) {
  static_assert(std::endian::native == std::endian::little, "glTF bytes are read in place");
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

// 0: not a component type of glTF 2.0.
std::uint64_t componentSize(int component_type) {
  switch (component_type) {
    case ComponentType::kByte:
    case ComponentType::kUnsignedByte:
      return 1;
    case ComponentType::kShort:
    case ComponentType::kUnsignedShort:
      return 2;
    case ComponentType::kUnsignedInt:
    case ComponentType::kFloat:
      return 4;
    default:
      return 0;
  }
}

// 0: a type that nothing we read may have (smaller matrices, whose columns may be padded).
std::uint64_t componentCount(ElementType type) {
  switch (type) {
    case ElementType::kScalar:
      return 1;
    case ElementType::kVec2:
      return 2;
    case ElementType::kVec3:
      return 3;
    case ElementType::kVec4:
      return 4;
    case ElementType::kMat4:
      return 16;
    default:
      return 0;
  }
}

struct Range {
  const char* data = nullptr;
  std::uint64_t stride = 0;
};

struct RangeRequest {
  int buffer_view;
  std::uint64_t offset;        // in the view, bytes
  std::uint64_t count;         // elements
  std::uint64_t element_size;  // bytes
};

// Checks that the elements lie in the buffer view and the view in its buffer.
Result<Range> viewRange(const Document& document, const RangeRequest& request, const std::string& user) {
  const auto& views = document.file.buffer_views;
  const std::string& name = document.name;
  if (!isIndexInto(request.buffer_view, views.size())) {
    return failure("{}: {}: buffer view {} does not exist (the file has {})", name, user, request.buffer_view,
                   views.size());
  }
  const GltfFile::BufferView& view = views[static_cast<std::size_t>(request.buffer_view)];
  if (!isIndexInto(view.buffer, document.buffers.bytes.size())) {
    return failure("{}: buffer view {}: buffer {} does not exist (the file has {})", name,
                   request.buffer_view, view.buffer, document.buffers.bytes.size());
  }
  const std::string_view buffer = document.buffers.bytes[static_cast<std::size_t>(view.buffer)];
  if (view.byte_offset > buffer.size() || view.byte_length > buffer.size() - view.byte_offset) {
    return failure("{}: buffer view {}: {} bytes from byte {} do not lie in buffer {} of {} bytes", name,
                   request.buffer_view, view.byte_length, view.byte_offset, view.buffer, buffer.size());
  }
  const std::uint64_t stride = view.byte_stride == 0 ? request.element_size : view.byte_stride;
  if (stride < request.element_size) {
    return failure("{}: {}: elements of {} bytes overlap at the stride of {} of buffer view {}", name, user,
                   request.element_size, stride, request.buffer_view);
  }
  // Last element's end, without overflow: offset and length are below 2^53, the stride below 2^8.
  const bool fits =
      request.count == 0 ||
      (request.offset <= view.byte_length && request.element_size <= view.byte_length - request.offset &&
       request.count - 1 <= (view.byte_length - request.offset - request.element_size) / stride);
  if (!fits) {
    return failure(
        "{}: {}: {} elements of {} bytes every {} from byte {} do not lie in buffer view {} of {} bytes",
        name, user, request.count, request.element_size, stride, request.offset, request.buffer_view,
        view.byte_length);
  }
  return Range{buffer.data() + view.byte_offset + (request.count == 0 ? 0 : request.offset), stride};
}

}  // namespace

const char* AccessorView::addressOf(std::uint64_t element) const {
  if (!replaced_.empty()) {
    const auto found = std::lower_bound(replaced_.begin(), replaced_.end(), element);
    if (found != replaced_.end() && *found == element) {
      return replacements_ + element_size_ * static_cast<std::uint64_t>(found - replaced_.begin());
    }
  }
  return data_ == nullptr ? nullptr : data_ + stride_ * element;
}

double AccessorView::number(std::uint64_t element, int component) const {
  const char* const address = addressOf(element);
  if (address == nullptr) {
    return 0.0;
  }
  switch (component_type_) {
    case ComponentType::kByte: {
      const double value = readAs<std::int8_t>(address + component);
      return normalized_ ? std::max(value / 127.0, -1.0) : value;
    }
    case ComponentType::kUnsignedByte: {
      const double value = readAs<std::uint8_t>(address + component);
      return normalized_ ? value / 255.0 : value;
    }
    case ComponentType::kShort: {
      const double value = readAs<std::int16_t>(address + 2 * component);
      return normalized_ ? std::max(value / 32767.0, -1.0) : value;
    }
    case ComponentType::kUnsignedShort: {
      const double value = readAs<std::uint16_t>(address + 2 * component);
      return normalized_ ? value / 65535.0 : value;
    }
    case ComponentType::kUnsignedInt:
      return readAs<std::uint32_t>(address + 4 * component);
    default:
      return static_cast<double>(readAs<float>(address + 4 * component));
  }
}

std::uint32_t AccessorView::index(std::uint64_t element) const {
  const char* const address = addressOf(element);
  if (address == nullptr) {
    return 0;
  }
  switch (component_type_) {
    case ComponentType::kUnsignedByte:
      return readAs<std::uint8_t>(address);
    case ComponentType::kUnsignedShort:
      return readAs<std::uint16_t>(address);
    default:
      return readAs<std::uint32_t>(address);
  }
}

// The replaced elements of a sparse accessor whose own fields are set.
Status addSparse(const Document& document, int accessor, AccessorView& view) {
  const GltfFile::Sparse& sparse = *document.file.accessors[static_cast<std::size_t>(accessor)].sparse;
  const std::string where = fmt::format("accessor {} sparse", accessor);
  const int type = sparse.indices_type;
  if (type != ComponentType::kUnsignedByte && type != ComponentType::kUnsignedShort &&
      type != ComponentType::kUnsignedInt) {
    return failure("{}: {}: component type {} is not an unsigned integer", document.name, where, type);
  }
  const std::uint64_t count = sparse.count;
  const RangeRequest request{sparse.indices_view, sparse.indices_offset, count, componentSize(type)};
  const Result<Range> indices = viewRange(document, request, where + " indices");
  if (!indices) {
    return indices.error();
  }
  const Result<Range> values = viewRange(
      document, {sparse.values_view, sparse.values_offset, count, view.element_size_}, where + " values");
  if (!values) {
    return values.error();
  }
  if (indices->stride != request.element_size || values->stride != view.element_size_) {
    return failure("{}: {}: its buffer views must not have a stride", document.name, where);
  }
  AccessorView reader;
  reader.data_ = indices->data;
  reader.stride_ = indices->stride;
  reader.component_type_ = type;
  view.replaced_.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint32_t index = reader.index(i);
    if (index >= view.count_ || (i > 0 && index <= view.replaced_.back())) {
      return failure("{}: {}: index {} at position {} is out of range or not ascending ({} elements)",
                     document.name, where, index, i, view.count_);
    }
    view.replaced_.push_back(index);
  }
  view.replacements_ = values->data;
  return Success{};
}

// Precondition: the accessor exists.
Result<AccessorView> openAccessor(const Document& document, int accessor, const std::string& user) {
  const GltfFile::Accessor& source = document.file.accessors[static_cast<std::size_t>(accessor)];
  const std::string where = fmt::format("accessor {}", accessor);
  AccessorView view;
  view.count_ = source.count;
  view.component_type_ = source.type_of_component;
  view.type_ = source.type;
  view.normalized_ = source.normalized;
  view.element_size_ = componentSize(source.type_of_component) * componentCount(source.type);
  if (view.element_size_ == 0) {
    return failure("{}: {}: component type {} or its type cannot be used for {}", document.name, where,
                   source.type_of_component, user);
  }
  if (source.buffer_view >= 0) {
    const Result<Range> range = viewRange(
        document, {source.buffer_view, source.byte_offset, source.count, view.element_size_}, where);
    if (!range) {
      return range.error();
    }
    view.data_ = range->data;
    view.stride_ = range->stride;
  } else if (source.count > document.limits.implied_elements) {
    return failure("{}: {}: has {} elements without a buffer view; at most {} are read", document.name, where,
                   source.count, document.limits.implied_elements);
  }
  if (source.sparse) {
    const Status status = addSparse(document, accessor, view);
    if (!status) {
      return status.error();
    }
  }
  return view;
}

Result<const AccessorView*> Accessors::view(int accessor, const std::string& user) {
  if (!isIndexInto(accessor, views_.size())) {
    return failure("{}: {}: accessor {} does not exist (the file has {})", document_.name, user, accessor,
                   views_.size());
  }
  std::optional<AccessorView>& view = views_[static_cast<std::size_t>(accessor)];
  if (!view) {
    Result<AccessorView> opened = openAccessor(document_, accessor, user);
    if (!opened) {
      return opened.error();
    }
    view = std::move(*opened);
  }
  return &*view;
}

}  // namespace sightline::io
