// SPDX-License-Identifier: BSD-3-Clause
//
// Arguments of ArticulatedCollisionManager's members for an object and for a link.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic {

/// An FCL object as an argument: a pointer to an object that the caller keeps alive, or a std::shared_ptr, in which the
/// callee then keeps a share. Either becomes an ObjectRef by itself.
template <typename Object>
class ObjectRef {
 public:
  /// An object that the caller keeps alive.
  ObjectRef(const Object* object) : shared_(std::shared_ptr<void>(), object) {}
  /// An object that the callee keeps alive, too.
  template <typename Shared, typename = std::enable_if_t<std::is_convertible_v<Shared*, const Object*>>>
  ObjectRef(std::shared_ptr<Shared> object) : shared_(std::move(object)) {}

  /// The object, or null.
  const Object* get() const { return shared_.get(); }
  /// The caller's share in the object; one that owns nothing where a pointer was given.
  const std::shared_ptr<const Object>& share() const { return shared_; }

 private:
  std::shared_ptr<const Object> shared_;
};

/// A link as an argument: its LinkId, or its name. Either becomes a LinkRef by itself. It refers to the name and must
/// not outlive it.
class LinkRef {
 public:
  /// The link of this number.
  LinkRef(LinkId link) : id_(link) {}
  /// The link of this name.
  LinkRef(const std::string& name) : name_(name), by_name_(true) {}
  /// The link of this name.
  LinkRef(std::string_view name) : name_(name), by_name_(true) {}
  /// The link of this name.
  LinkRef(const char* name) : name_(name), by_name_(true) {}

  /// Whether the link is given by its name.
  bool byName() const { return by_name_; }
  /// The number, where the link is not given by its name.
  LinkId id() const { return id_; }
  /// The name, where the link is given by it.
  std::string_view name() const { return name_; }

 private:
  LinkId id_ = -1;
  std::string_view name_;
  bool by_name_ = false;
};

}  // namespace fcl_artic
