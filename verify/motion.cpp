// SPDX-License-Identifier: BSD-3-Clause
#include "motion.h"

namespace verify {

// t = centre + half s. The centre is rounded down, the half up: the model's range of t covers [a, b], and at most 2 ulp
// more. Then Horner's scheme in Taylor models.
Tm Poses::variable(int v, const Span& span) const {
  const auto q = piece_.polynomials.find(v);
  if (q == piece_.polynomials.end()) return {};
  const Fix centre = span.middle();
  const Tm t{centre, std::max(span.b - centre, centre - span.a), {}, {}};
  Tm value;
  for (std::size_t k = q->second.size(); k-- > 0;) value = value * t + exactly(q->second[k]);
  return value;
}

Pose Poses::compute(int index, std::size_t first, Pose pose, const Span& span) const {
  const std::vector<Element>& elements = world_.frames[index].elements;
  for (std::size_t k = first; k < elements.size(); ++k) {
    const Element& e = elements[k];
    // Measured: a slide takes 2 us, a turn 6, a rotation vector 20, and 5 more each time that it is halved.
    budget_.spend(e.kind == Element::rotate ? 1000 : e.kind == Element::turn ? 300 : 100);
    if (e.kind == Element::rotate) {
      const Vec w{variable(e.variable, span), variable(e.variable + 1, span), variable(e.variable + 2, span)};
      for (Fix z = bound(dot(w, w)); z > integer(100); z = shifted(z, 2)) budget_.spend(250);
      pose.R = pose.R * rotation(w);
      const auto given = piece_.orientations.find(e.variable);
      if (given != piece_.orientations.end()) pose.R = pose.R * statedRotation(given->second.data());
      continue;
    }
    const Tm value = exactly(e.multiplier) * variable(e.variable, span) + exactly(e.offset);
    if (e.kind == Element::slide) {
      pose.t = pose.t + pose.R * Vec{e.unit[0] * value, e.unit[1] * value, e.unit[2] * value};
    } else {
      pose.R = pose.R * rotation(e.unit, e.products, value);
    }
  }
  return pose;
}

const Pose& Poses::local(int frame, const Span& span) {
  if (world_.frames[frame].elements.empty()) return world_.frames[frame].origin;
  if (known_.size() > 20000) known_.clear();
  const std::tuple key(span.a.v, span.b.v, frame);
  const auto found = known_.find(key);
  return found != known_.end()
             ? found->second
             : known_.emplace(key, compute(frame, 0, world_.frames[frame].origin, span)).first->second;
}

Pose Poses::after(int frame, int element, const Span& span) const {
  Pose here{};
  for (std::size_t k = 0; k < 9; k += 4) here.R[k] = constant(integer(1));
  return compute(frame, static_cast<std::size_t>(element + 1), here, span);
}

// x = R y + t: v.x + d = (R^T v).y + (d + v.t), and v.y + d = v.R^T (x - t) + d = (R v).x + (d - (R v).t).
Functional::Value toChild(const Functional::Value& f, const Pose& pose) {
  return {transposed(pose.R, f.v), f.d + dot(f.v, pose.t)};
}
Functional::Value toParent(const Functional::Value& f, const Pose& pose) {
  const Vec v = pose.R * f.v;
  return {v, f.d - dot(v, pose.t)};
}

Functional::Functional(const World& world, Poses& poses, const Span& span, int frame, const Vec& v, const Tm& d)
    : world_(world), poses_(poses), span_(span) {
  known_.emplace(frame, Value{v, d});
  for (int child = frame, up; child != 0; child = up) {
    poses.spend(1);
    up = world.frames[child].parent;
    towards_.emplace(up, child);
  }
}

const Functional::Value& Functional::in(int frame) {
  const auto found = known_.find(frame);
  if (found != known_.end()) return found->second;
  poses_.spend(25);
  const auto ancestor = towards_.find(frame);
  // Recursion ends: an ancestor of the first frame asks for its child towards it, another frame for its parent; at the
  // latest frame 0 is an ancestor. The chain is at most 1000 frames deep (statement.cpp).
  // The function comes first, then the pose: asking for another pose may drop this one.
  const bool up = ancestor != towards_.end();
  const Value& near = in(up ? ancestor->second : world_.frames[frame].parent);
  const Value value =
      up ? toParent(near, poses_.local(ancestor->second, span_)) : toChild(near, poses_.local(frame, span_));
  return known_.emplace(frame, value).first->second;
}

Functional::Value Functional::inBody(int body) {
  return toChild(in(world_.bodies[body].frame), world_.bodies[body].pose);
}

}  // namespace verify
