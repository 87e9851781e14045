// SPDX-License-Identifier: BSD-3-Clause
#include "script.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace recording {

std::vector<Entry>& tape() {
  static std::vector<Entry> entries(1);
  return entries;
}
std::vector<std::pair<Recorded, Recorded>>& comparisons() {
  static std::vector<std::pair<Recorded, Recorded>> all;
  return all;
}
int record(Operation operation, Recorded a, Recorded b, Recorded c) {
  tape().push_back({operation, {{a.node, a.value}, {b.node, b.value}, {c.node, c.value}}});
  return static_cast<int>(tape().size()) - 1;
}

namespace {

/// A double, exactly, in Gappa's words.
std::string exactly(Real x) {
  if (x == 0) return "0";
  int exponent;
  const Real m = std::frexp(x, &exponent);
  char text[64];
  std::snprintf(text, sizeof text, "%lldb%d", static_cast<long long>(std::ldexp(m, 53)), exponent - 53);
  return text;
}
std::string within(Real least, Real most) {
  return " in [" + exactly(least) + ", " + exactly(most) + "]";
}

/// The text of what some nodes are computed from.
class Writer {
 public:
  explicit Writer(const Arithmetic& arithmetic) : arithmetic_(arithmetic), done_(tape().size(), false) {
    text_ = std::string("@rnd = float<ieee_64, ") + arithmetic.mode + ">;\n";
  }
  const std::string& text() const { return text_; }
  bool wrote(int node) const { return done_[node]; }

  void write(int node) {
    if (node == 0 || done_[node]) return;
    done_[node] = true;
    const Entry& e = tape()[node];
    if (e.operation != Operation::input) {
      for (const Operand& o : e.of) write(o.node);
    }
    const std::string n = std::to_string(node);
    switch (e.operation) {
      case Operation::input:
        return;
      case Operation::negative:
        return define(n, "-" + name('t', e.of[0]), "-" + name('M', e.of[0]));
      case Operation::root:
        return define(n, "rnd(sqrt(" + name('t', e.of[0]) + "))", "sqrt(" + name('M', e.of[0]) + ")");
      case Operation::product_plus: {
        if (!arithmetic_.fused) {
          define(n + "p", "rnd(" + infix('t', e, " * ") + ")", infix('M', e, " * "));
          return define(n, "rnd(t" + n + "p + " + name('t', e.of[2]) + ")", "M" + n + "p + " + name('M', e.of[2]));
        }
        return define(n, "rnd(" + infix('t', e, " * ") + " + " + name('t', e.of[2]) + ")",
                      infix('M', e, " * ") + " + " + name('M', e.of[2]));
      }
      default: {
        const char* sign = e.operation == Operation::sum          ? " + "
                           : e.operation == Operation::difference ? " - "
                           : e.operation == Operation::product    ? " * "
                                                                  : " / ";
        return define(n, "rnd(" + infix('t', e, sign) + ")", infix('M', e, sign));
      }
    }
  }
  static std::string name(char as, const Operand& o) {
    if (o.node == 0) return o.value < 0 ? "(" + exactly(o.value) + ")" : exactly(o.value);
    return (tape()[o.node].operation == Operation::input ? 'i' : as) + std::to_string(o.node);
  }
  static std::string name(char as, const Recorded& x) { return name(as, Operand{x.node, x.value}); }

 private:
  static std::string infix(char as, const Entry& e, const char* sign) {
    return name(as, e.of[0]) + sign + name(as, e.of[1]);
  }
  void define(const std::string& n, const std::string& computed, const std::string& exact) {
    text_ += "t" + n + " = " + computed + ";\nM" + n + " = " + exact + ";\n";
  }

  Arithmetic arithmetic_;
  std::vector<bool> done_;
  std::string text_;
};

}  // namespace

Statement::Statement() {
  tape().resize(1);
  comparisons().clear();
}

Recorded Statement::input(Real least, Real most) {
  static unsigned state = 1;
  state = state * 1664525U + 1013904223U;
  const Real part = 0.1 + 0.8 * (state >> 8) / 0x1p24;
  const Recorded x = {least + part * (most - least), record(Operation::input, 0.0)};
  inputs_.push_back({x.node, least, most});
  return x;
}

void Statement::known(Recorded x, Real bound) {
  if (x.node != 0 && tape()[x.node].operation != Operation::input) known_.push_back({x.node, bound});
}

std::vector<int> Statement::knownDots(const std::vector<int>& a, const std::vector<int>& b, Real bound) {
  const auto in = [](const std::vector<int>& all, const Operand& o) {
    return o.node != 0 && std::find(all.begin(), all.end(), o.node) != all.end();
  };
  std::vector<int> found;
  for (int node = 1; node < static_cast<int>(tape().size()); ++node) {
    const Entry& e = tape()[node];
    if (e.operation != Operation::product_plus && e.operation != Operation::product) continue;
    if (!(in(a, e.of[0]) && in(b, e.of[1])) && !(in(b, e.of[0]) && in(a, e.of[1]))) continue;
    known_.push_back({node, bound});
    found.push_back(node);
  }
  return found;
}

std::string Statement::script(const Arithmetic& arithmetic, Real factor, bool ask) const {
  Writer writer(arithmetic);
  for (const Term& term : terms_) {
    writer.write(term.a.node);
    writer.write(term.b.node);
  }
  std::string text = writer.text() + "{ ", premises, goals;
  for (const Input& i : inputs_) {
    if (!writer.wrote(i.node)) continue;
    premises += (premises.empty() ? "" : " /\\\n") + ("i" + std::to_string(i.node)) + within(i.least, i.most);
  }
  for (const Known& k : known_) {
    if (!writer.wrote(k.node)) continue;
    premises += " /\\\nM" + std::to_string(k.node) + within(-k.bound, k.bound);
  }
  for (const Term& term : terms_) {
    const auto pair = [&](char as) {
      const std::string a = Writer::name(as, term.a);
      return term.b.is(0) ? a : "(" + a + " - " + Writer::name(as, term.b) + ")";
    };
    const Real bound = term.bound * factor;
    goals += goals.empty() ? "" : " /\\\n";
    if (term.kind == Kind::order) {
      goals += pair('t') + (ask ? " in ?" : " <= " + exactly(bound));
      continue;
    }
    goals += (term.kind == Kind::part ? pair('t') + " -/ " : pair('t') + " - ") + pair('M');
    goals += ask ? " in ?" : within(-bound, bound);
  }
  return text + premises + "\n->\n" + goals + " }\n";
}

std::vector<Real> Statement::bounds() const {
  std::vector<Real> all;
  for (const Term& term : terms_) all.push_back(term.bound);
  return all;
}

void Statement::cut(Recorded x, Real least, Real most) {
  tape()[x.node].operation = Operation::input;
  inputs_.push_back({x.node, least, most});
}

}  // namespace recording
