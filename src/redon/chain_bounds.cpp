// SPDX-License-Identifier: BSD-3-Clause
//
// Symbols: T: the time interval; tm, d: its middle and half its length; X: rotation or origin of a frame. A step's
// frame is the one before it times the constant (C, p) and the factor J(t), which turns with angular velocity W and
// slides by l:
//   R = R_p C J,  o = o_p + R_p (p + C l),  w = w_p + R_p C W,  R' = [w] R,  R'' = ([w'] + [w][w]) R
// The same recursion over intervals of time (the paper's bounds), and over one instant, where all intervals are a few
// ulp wide.
#include "redon/chain_bounds.h"

#include <vector>

#include "interval/sine_cosine.h"
#include "interval/turn_series.h"
#include "numerics/arc_tangent.h"

#define FCL_ARTIC_ISA interval_chain
#define FCL_ARTIC_ISA_BITS 128
#include "motion/chain.h"
#include "motion/frame_sweep.h"

namespace fcl_artic {

using engine::StepKind;
using engine::SweepStep;
using interval_chain::StepBounds;

namespace {

/// Sum of a chain's turns over an interval, in rad. From this sum on, interval products cut something off the Taylor
/// enclosure, whose remainder grows with the third power (doc/REDON2004.md, "Enclosures").
constexpr double kSmallTurn = 3;

/// 2^-52 times that, rounded up.
Interval ulps(double number) {
  return plusMinus((Interval(0x1p-52) * number).upper());
}

/// A matrix of rotations with an error of at most that in the Frobenius norm; entries of rotations lie in [-1, 1].
void addError(IntervalMat3& R, Interval error) {
  for (Interval& x : R.m) x = intersection(x + error, Interval(-1, 1));
}
void addError(IntervalVec3& x, Interval error) {
  for (Interval& e : x.v) e += error;
}
void cutToUnit(IntervalMat3& R) {
  for (Interval& x : R.m) x = intersection(x, Interval(-1, 1));
}

Interval norm(const IntervalVec3& x) {
  return sqrt((square(x[0]) + square(x[1])) + square(x[2]));
}

IntervalVec3 zero() {
  return {Interval(0.0), Interval(0.0), Interval(0.0)};
}

/// [w] R
IntervalMat3 crossColumns(const IntervalVec3& w, const IntervalMat3& R) {
  IntervalMat3 o;
  for (int j = 0; j < 3; ++j) {
    const IntervalVec3 x = cross(w, R.column(j));
    for (int k = 0; k < 3; ++k) o(k, j) = x[k];
  }
  return o;
}

/// A variable over an interval of time, with its first two derivatives.
struct Variable {
  Interval q, q1, q2;
};

/// A polynomial over T, from its Taylor coefficients at the middle of T. Powers of T - tm depend on each other, and the
/// width that this costs shrinks with the square of T.
Variable evaluatePolynomial(const Interval* coefficients, int degree, Interval T) {
  if (degree == 1) return {coefficients[0] + coefficients[1] * T, coefficients[1], Interval(0.0)};
  const double middle = T.middle();
  Interval c[engine::kMaxDegree + 1] = {};
  for (int k = 0; k <= degree; ++k) c[k] = coefficients[k];
  for (int j = 0; j < degree; ++j) {
    for (int k = degree - 1; k >= j; --k) c[k] += c[k + 1] * middle;
  }
  Interval power[engine::kMaxDegree + 1] = {};
  power[0] = Interval(1.0);
  power[1] = T - Interval(middle);
  for (int k = 2; k <= degree; ++k) power[k] = k % 2 ? power[k - 1] * power[1] : square(power[k / 2]);
  Variable v = {c[0], c[1], c[2] * 2.0};
  for (int k = 1; k <= degree; ++k) {
    v.q += c[k] * power[k];
    if (k > 1) v.q1 += c[k] * power[k - 1] * static_cast<double>(k);
    if (k > 2) v.q2 += c[k] * power[k - 2] * static_cast<double>(k * (k - 1));
  }
  return v;
}

/// m (reference + 2 atan(s)) + o over a range of s and its derivatives: monotone in s.
Variable angleOf(const Variable& s, Interval m, Interval offset) {
  const Interval error = plusMinus(2 * kArcTangentError);
  const Interval angle = hull(Interval(2 * arcTangent(s.q.lower())), Interval(2 * arcTangent(s.q.upper()))) + error;
  const Interval g = Interval(2.0) / (Interval(1.0) + square(s.q)), rate = g * s.q1;
  return {m * angle + offset, m * rate, m * (g * s.q2 - s.q * square(rate))};
}

/// A factor's own motion: rotation and slide, the slide's derivatives, angular velocity and acceleration.
struct Factor {
  IntervalMat3 J;
  IntervalVec3 l, l1, l2, W, W1;
};

/// cos + (sin) [u] + (1 - cos) u u^T
IntervalMat3 turnAbout(const IntervalVec3& u, Interval angle) {
  Interval s, c;
  encloseSineCosine(angle, s, c);
  const Interval rest = Interval(1.0) - c;
  IntervalMat3 J;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Interval own = square(u[i]), across = rest * (u[i] * u[j]), along = s * u[k];
    J(i, i) = own + c * (Interval(1.0) - own);
    J(i, j) = across - along;
    J(j, i) = across + along;
  }
  cutToUnit(J);
  return J;
}

/// exp([q]) for a rotation vector of any course (doc/NUMERICS.md, section 2: `turnByVector`).
void turnByVector(const Variable* v, Factor& f) {
  const IntervalVec3 q(v[0].q, v[1].q, v[2].q), q1(v[0].q1, v[1].q1, v[2].q1), q2(v[0].q2, v[1].q2, v[2].q2);
  const Interval g = (square(q[0]) + square(q[1])) + square(q[2]);
  const TurnSeries s = turnSeries(g);
  const Interval cosine = Interval(1.0) - s.b * g;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Interval across = s.b * (q[i] * q[j]), along = s.a * q[k];
    f.J(i, i) = cosine + s.b * square(q[i]);
    f.J(i, j) = across - along;
    f.J(j, i) = across + along;
  }
  cutToUnit(f.J);
  const Interval g1 = dot(q, q1) * 2.0;
  const IntervalVec3 u = cross(q, q1), uu = cross(q, u);
  f.W = q1 + u * s.b + uu * s.c;
  f.W1 = q2 + u * (s.b1 * g1) + cross(q, q2) * s.b + uu * (s.c1 * g1) + (cross(q1, u) + cross(q, cross(q, q2))) * s.c;
}

IntervalVec3 vectorWithin(const double* x, double part) {
  IntervalVec3 o(x);
  addError(o, plusMinus((norm(o) * part).upper()));
  return o;
}

/// The factor that a motion's author states, over T: its state at the middle, and how far the bounds let that go. Or
/// the inverse (R^T, -R^T c), whose derivatives doc/NUMERICS.md and motion/factors.h give.
void boundedFactor(const SweepStep& step, Interval T, Factor& f) {
  const double middle = T.middle();
  double x[24], bound[6];
  {
    const RoundToNearest authors_code;
    const engine::BoundedSource& source = *step.source;
    source.state(source.self, middle, x);
    source.bounds(source.self, T.lower() > 0 ? T.lower() : 0, T.upper() < 1 ? T.upper() : 1, bound);
  }
  const double half = (T - Interval(middle)).magnitude();
  constexpr double part = kBoundedUlps * kUlp;
  const auto drift = [&](double b) { return plusMinus((Interval(half) * b).upper()); };
  const auto far = [&](double b) { return plusMinus((Interval(b) * (1 + part)).upper()); };

  f.J = IntervalMat3(x);
  addError(f.J, drift(bound[3]) + plusMinus(part));
  f.l = vectorWithin(x + 9, part);
  addError(f.l, drift(bound[0]));
  if (step.source->derivatives) {
    f.l1 = vectorWithin(x + 12, part);
    addError(f.l1, drift(bound[1]));
    f.l2 = vectorWithin(x + 15, part);
    addError(f.l2, drift(bound[2]));
    f.W = vectorWithin(x + 18, part);
    addError(f.W, drift(bound[4]));
    f.W1 = vectorWithin(x + 21, part);
    addError(f.W1, drift(bound[5]));
  } else {
    const Interval speed = far(bound[0]), turn = far(bound[3]), any = Interval::entire();
    f.l1 = {speed, speed, speed};
    f.W = {turn, turn, turn};
    f.l2 = f.W1 = {any, any, any};
  }
  if (!step.inverse) return;
  const IntervalMat3 R = transpose(f.J);
  const IntervalVec3 Wl = cross(f.W, f.l);
  const IntervalVec3 l2 = cross(f.W1, f.l) - cross(f.W, Wl) + cross(f.W, f.l1) * 2.0 - f.l2;
  f.J = R;
  f.l2 = R * l2;
  f.l1 = R * (Wl - f.l1);
  f.l = -(R * f.l);
  f.W1 = -(R * f.W1);
  f.W = -(R * f.W);
}

/// A step's variables under one motion.
struct StepMotion {
  Interval q[3][engine::kMaxDegree + 1];
  int degree = 0;
  bool half_angle = false;    ///< q[0] is the tangent s of half an angle
  Interval multiple, offset;  ///< of that angle
  Variable only(Interval T) const {
    const Variable x = evaluatePolynomial(q[0], degree, T);
    return half_angle ? angleOf(x, multiple, offset) : x;
  }
  /// A turn about one axis: q(t) = length axis t^power, the course of a free body; power -1: not so.
  int power = -1;
  IntervalVec3 axis;
  Interval length;
};

/// X times a turn about z.
void turnAboutZ(const IntervalMat3& X, Interval angle, IntervalMat3& R) {
  Interval sine, cosine;
  encloseSineCosine(angle, sine, cosine);
  for (int k = 0; k < 3; ++k) {
    R(k, 0) = X(k, 0) * cosine + X(k, 1) * sine;
    R(k, 1) = X(k, 1) * cosine - X(k, 0) * sine;
    R(k, 2) = X(k, 2);
  }
}

/// The factor of a turn by a rotation vector.
void turnFactor(const StepMotion& s, Interval T, Factor& factor) {
  Variable q[3];
  for (int k = 0; k < 3; ++k) q[k] = evaluatePolynomial(s.q[k], s.degree, T);
  if (s.power < 0) return turnByVector(q, factor);
  Interval power(1.0);
  for (int k = 0; k < s.power; ++k) power *= T;
  factor.J = turnAbout(s.axis, s.length * power);
  factor.W = {q[0].q1, q[1].q1, q[2].q1};
  factor.W1 = {q[0].q2, q[1].q2, q[2].q2};
}

/// X times such a factor, with the orientation before it or after it.
/// @param[in,out] X  with the orientation, if that comes before the factor.
void turn(const SweepStep& step, const double* orientations, const IntervalMat3& J, IntervalMat3& X, IntervalMat3& R) {
  IntervalMat3 R0;
  if (step.orientation >= 0) {
    R0 = IntervalMat3(orientations + 9 * step.orientation);
    addError(R0, ulps(Rotation::kUlps));
    if (step.inverse) X = X * transpose(R0);
    cutToUnit(X);
  }
  R = X * J;
  if (step.orientation >= 0 && !step.inverse) {
    cutToUnit(R);
    R = R * R0;
  }
}

/// The factor of a translation.
void slideFactor(const StepMotion& s, Interval T, Factor& factor) {
  for (int k = 0; k < 3; ++k) {
    const Variable q = evaluatePolynomial(s.q[k], s.degree, T);
    factor.l[k] = q.q;
    factor.l1[k] = q.q1;
    factor.l2[k] = q.q2;
  }
}

/// Pose of a step's frame, angular velocity and acceleration, the origin's velocity and acceleration.
struct Frame {
  IntervalMat3 R;
  IntervalVec3 o, w, al, v, a;
};

}  // namespace

struct ChainBounds::Impl {
  engine::SweepView sweep;
  engine::Query query;
  std::vector<StepMotion> steps;
  std::vector<Frame> over, at;        ///< over the whole interval, and at its middle
  std::vector<StepBounds> constants;  ///< bounds on derivatives, for the remainder
  bool same_always = false;           ///< those hold for all of [0, 1]

  void reset();
  void evaluate(Interval T, Derivatives derivatives, std::vector<Frame>& frames) const;
  void taylor(Interval T, Derivatives derivatives, FrameBounds* out);
};

void ChainBounds::Impl::reset() {
  const std::size_t n = static_cast<std::size_t>(sweep.num_steps);
  steps.resize(n);
  over.resize(n);
  at.resize(n);
  constants.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const SweepStep& step = sweep.steps[i];
    StepMotion& s = steps[i];
    s.power = -1;
    if (step.kind == StepKind::bounded) continue;
    s.degree = query.degree;
    const int rows = step.kind == StepKind::slide || step.kind == StepKind::turn ? 3 : 1;
    int last = 0, powers = 0;
    for (int k = 0; k <= s.degree; ++k) {
      bool moves = false;
      for (int r = 0; r < rows; ++r) {
        const double c = query.coefficients[k * query.num_variables + step.variable + r];
        s.q[r][k] = Interval(c) * step.multiplier;
        moves = moves || c != 0;
      }
      if (moves) {
        last = k;
        ++powers;
      }
    }
    s.half_angle = rows == 1 && query.half_angles.has(step.variable);
    if (s.half_angle) {
      for (int k = 0; k <= s.degree; ++k)
        s.q[0][k] = Interval(query.coefficients[k * query.num_variables + step.variable]);
      s.multiple = Interval(step.multiplier);
      s.offset = Interval(query.half_angles.reference[step.variable]) * step.multiplier + Interval(step.offset);
      continue;
    }
    s.q[0][0] += Interval(step.offset);
    if (step.kind == StepKind::turn && powers == 1) {
      const IntervalVec3 q(s.q[0][last], s.q[1][last], s.q[2][last]);
      s.length = norm(q);
      if (s.length.certainlyPositive()) {
        s.power = last;
        for (int r = 0; r < 3; ++r) s.axis[r] = q[r] / s.length;
      }
    }
  }
  // Affine variables have the same bounds at all times.
  same_always = query.degree == 1 && !sweep.local_bounds;
  if (same_always) boundSteps(sweep, query, 0, 1, constants.data());
}

void ChainBounds::Impl::evaluate(Interval T, Derivatives derivatives, std::vector<Frame>& frames) const {
  const bool moving = derivatives != Derivatives::none, twice = derivatives == Derivatives::second;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const SweepStep& step = sweep.steps[i];
    const StepMotion& s = steps[i];
    const Frame* g = step.parent >= 0 ? &frames[static_cast<std::size_t>(step.parent)] : nullptr;
    Frame& f = frames[i];

    // The frame in which the factor acts. The model's C and p are within the stored errors of these: R_p turns an error
    // without stretching it.
    IntervalMat3 X = g ? timesConstant(g->R, step.C) : IntervalMat3(step.C);
    IntervalVec3 r = g ? g->R * step.p : IntervalVec3(step.p);
    addError(X, ulps(step.ulps));
    addError(r, ulps(step.ulps) * step.length);

    Factor factor;
    bool turns = true, slides = true;
    switch (step.kind) {
      case StepKind::revolute: {
        slides = false;
        const Variable q = s.only(T);
        turnAboutZ(X, q.q, f.R);
        factor.W = {Interval(0.0), Interval(0.0), q.q1};
        factor.W1 = {Interval(0.0), Interval(0.0), q.q2};
        break;
      }
      case StepKind::prismatic: {
        turns = false;
        const Variable q = s.only(T);
        factor.l = {Interval(0.0), Interval(0.0), q.q};
        factor.l1 = {Interval(0.0), Interval(0.0), q.q1};
        factor.l2 = {Interval(0.0), Interval(0.0), q.q2};
        break;
      }
      case StepKind::slide: {
        turns = false;
        slideFactor(s, T, factor);
        break;
      }
      case StepKind::turn: {
        slides = false;
        turnFactor(s, T, factor);
        turn(step, query.orientations, factor.J, X, f.R);
        break;
      }
      case StepKind::bounded:
        boundedFactor(step, T, factor);
        f.R = X * factor.J;
        break;
    }
    if (turns) {
      cutToUnit(f.R);
    } else {
      f.R = X;
    }
    if (slides) r = r + X * factor.l;
    f.o = g ? g->o + r : r;
    if (!moving) continue;

    // If there is no frame before this one, nothing carries it.
    f.w = g ? g->w : zero();
    f.v = g ? g->v + cross(g->w, r) : zero();
    if (twice) {
      f.al = g ? g->al : zero();
      f.a = g ? g->a + cross(g->al, r) + cross(g->w, cross(g->w, r)) : zero();
    }
    if (turns) {
      const IntervalVec3 own = X * factor.W;
      if (twice) f.al = f.al + (g ? cross(g->w, own) : zero()) + X * factor.W1;
      f.w = f.w + own;
    }
    if (slides) {
      const IntervalVec3 own = X * factor.l1;
      f.v = f.v + own;
      if (twice) f.a = f.a + (g ? cross(g->w, own) * 2.0 : zero()) + X * factor.l2;
    }
  }
}

/// Writes the pose of a moving frame, and as many of the pose's derivatives as are asked for.
void write(const Frame& f, Derivatives derivatives, FrameBounds& out) {
  out.pose = {f.R, f.o};
  if (derivatives == Derivatives::none) return;
  out.rate = {crossColumns(f.w, f.R), f.v};
  if (derivatives == Derivatives::first) return;
  out.second = {crossColumns(f.al, f.R) + crossColumns(f.w, out.rate.R), f.a};
}

namespace {

/// x0 + tau x1 + tau^2 x2 for tau in [-1, 1]: within the hull of its Bernstein coefficients.
Interval quadraticOver(Interval x0, Interval x1, Interval x2, Interval remainder) {
  const Interval sum = x0 + x2;
  return hull(hull(sum - x1, sum + x1), x0 - x2) + remainder;
}

/// Taylor's formula for one entry and its derivatives; third: bound of the third derivative.
struct TaylorTerms {
  Interval d, half_square, span;  ///< d, d^2/2, [-d, d]
  Interval pose, rate, second;    ///< remainders
  void apply(Interval& x, Interval& x1, Interval& x2, Derivatives derivatives) const {
    const Interval at1 = x1, at2 = x2;
    x = quadraticOver(x, at1 * d, at2 * half_square, pose);
    if (derivatives != Derivatives::none) x1 = (at1 + at2 * span) + rate;
    if (derivatives == Derivatives::second) x2 = at2 + second;
  }
};

}  // namespace

void ChainBounds::Impl::taylor(Interval T, Derivatives derivatives, FrameBounds* out) {
  const double middle = T.middle(), half = (T - Interval(middle)).magnitude();
  if (!same_always) {
    const double begin = T.lower(), end = T.upper();
    const RoundToNearest authors_code;
    boundSteps(sweep, query, begin, end, constants.data());
  }
  evaluate(Interval(middle), sweep.first_order ? Derivatives::none : Derivatives::second, at);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const StepBounds& b = constants[i];
    FrameBounds& o = out[i];
    write(at[i], sweep.first_order ? Derivatives::none : Derivatives::second, o);
    const interval_chain::Remainder rest = remainderOf(b.rates, b.D1, b.D3, sweep.first_order, b.ulps, half);
    if (sweep.first_order) {  // |X - X(tm)| <= sup |X'| d, and no more is known
      for (int k = 0; k < 9; ++k) {
        o.pose.R.m[k] += plusMinus(rest.R);
        o.rate.R.m[k] = plusMinus(b.rates.first() * (1 + 1e-9));
        o.second.R.m[k] = Interval::entire();
      }
      for (int k = 0; k < 3; ++k) {
        o.pose.t[k] += plusMinus(rest.c);
        o.rate.t[k] = plusMinus(b.D1 * (1 + 1e-9));
        o.second.t[k] = Interval::entire();
      }
      continue;
    }
    // d^3/6, d^2/2 and d times the bound of the third derivative; its rounding is below 1e-9 of it (NUMERICS, "Pads").
    const auto terms = [&](double third, double remainder) {
      const Interval d(half), large = Interval(third) * (1 + 1e-9);
      TaylorTerms t;
      t.d = d;
      t.half_square = square(d) * 0.5;
      t.span = plusMinus(half);
      t.pose = plusMinus(remainder);
      t.rate = plusMinus((large * t.half_square).upper());
      t.second = plusMinus((large * d).upper());
      return t;
    };
    const TaylorTerms R = terms(b.rates.third(), rest.R), c = terms(b.D3, rest.c);
    for (int k = 0; k < 9; ++k) R.apply(o.pose.R.m[k], o.rate.R.m[k], o.second.R.m[k], derivatives);
    for (int k = 0; k < 3; ++k) c.apply(o.pose.t[k], o.rate.t[k], o.second.t[k], derivatives);
    cutToUnit(o.pose.R);
  }
}

namespace {

void cutWith(const FrameBounds& other, Derivatives derivatives, FrameBounds& b) {
  b.pose = intersection(b.pose, other.pose);
  if (derivatives != Derivatives::none) b.rate = intersection(b.rate, other.rate);
  if (derivatives == Derivatives::second) b.second = intersection(b.second, other.second);
}

}  // namespace

ChainBounds::ChainBounds() : impl_(new Impl) {}
ChainBounds::~ChainBounds() = default;
ChainBounds::ChainBounds(ChainBounds&&) noexcept = default;
ChainBounds& ChainBounds::operator=(ChainBounds&&) noexcept = default;

void ChainBounds::reset(const engine::SweepView& sweep, const engine::Query& query) {
  const RoundUpward upward;
  impl_->sweep = sweep;
  impl_->query = query;
  impl_->reset();
}

void ChainBounds::enclose(double begin, double end, Enclosure enclosure, Derivatives derivatives, FrameBounds* out) {
  const RoundUpward upward;
  const Interval T(begin, end);
  Impl& m = *impl_;
  if (enclosure == Enclosure::taylor) {
    m.taylor(T, derivatives, out);
    double turn = 0;
    for (const StepBounds& b : m.constants) turn = b.rates.first() > turn ? b.rates.first() : turn;
    if (turn * (end - begin) <= kSmallTurn) return;
  }
  const bool mean_value = enclosure == Enclosure::meanValue;
  const Derivatives needed = mean_value && derivatives == Derivatives::none ? Derivatives::first : derivatives;
  m.evaluate(T, needed, m.over);
  if (mean_value) m.evaluate(Interval(T.middle()), Derivatives::none, m.at);
  const Interval from_middle = T - Interval(T.middle());
  for (std::size_t i = 0; i < m.steps.size(); ++i) {
    FrameBounds chain;
    write(m.over[i], needed, chain);
    if (enclosure == Enclosure::taylor) {
      cutWith(chain, derivatives, out[i]);
      continue;
    }
    if (mean_value) {
      const IntervalTransform linear = {IntervalMat3(m.at[i].R) + scaled(chain.rate.R, from_middle),
                                        m.at[i].o + chain.rate.t * from_middle};
      chain.pose = intersection(chain.pose, linear);
    }
    out[i] = chain;
  }
}

IntervalTransform enclose(const engine::Placement& placement) {
  const RoundUpward upward;
  IntervalTransform o = {IntervalMat3(placement.R), IntervalVec3(placement.t)};
  addError(o.R, ulps(placement.ulps));
  addError(o.t, ulps(placement.ulps) * placement.length);
  return o;
}

}  // namespace fcl_artic
