#pragma once

// How much work a view may spend on finer depth buffers, and what each must take away.

#include <algorithm>

namespace sightline::culling {

// Says when a finer depth buffer pays, by counted work: 1 for an edge, as SurfaceLimits::budget counts.
//
// What a view costs on average for each object that it keeps, or a few edges' work, is the price of an
// object. A window pays where its work, as of the last ones, is at most `worth` times the price of the
// objects that it takes away.
class FocusBudget {
 public:
  explicit FocusBudget(double worth) : worth_(std::max(0.0, worth)) {}

  // A view begins: `work` was done for it, and it keeps so many objects before windows are drawn.
  void view(double work, double kept) {
    const double share = work_ == 0.0 ? 1.0 : 1.0 / kMemory;
    work_ += share * (work - work_);
    kept_ += share * (kept - kept_);
    spent_ = 0.0;
  }
  // A window that takes away fewer objects does not pay.
  double minObjects() const { return (window_ + kWindowWork) / price(); }
  // Work that may yet be done in this view, and for a window that is likely to take away so many objects.
  double left() const { return work_ - spent_; }
  double left(double objects) const { return std::min(left(), kSlack * objects * price()); }
  void drawn(double work) {
    spent_ += work;
    window_ += (work - window_) / kWindowMemory;
  }
  // No window was drawn. What one costs is forgotten slowly: the view may change.
  void idle() { window_ += (kUsualWindow - window_) / kMemory; }

 private:
  static constexpr double kMemory = 32.0, kWindowMemory = 16.0;  // views, windows
  static constexpr double kMinPrice = 5.0;                       // of an object, about a microsecond
  static constexpr double kUsualWindow = 500.0;                  // work of a window of which nothing is known
  static constexpr double kSlack = 2.0;                          // windows differ in what they take
  static constexpr double kWindowWork = 100.0;                   // of a window, beside what it draws

  double price() const { return worth_ * std::max(work_ / std::max(kept_, 1.0), kMinPrice); }

  double worth_;
  double work_ = 0.0, kept_ = 0.0;  // of a view, on average
  double window_ = kUsualWindow;    // work of a window, on average
  double spent_ = 0.0;              // in this view
};

}  // namespace sightline::culling
