// SPDX-License-Identifier: BSD-3-Clause
//
// Objects and links as arguments of the manager: by pointer or shared_ptr, by number or name.
#include "fcl_artic/references.h"

#include <gtest/gtest.h>

#include <string_view>

#include "query/arms.h"

namespace references_test {

using namespace fcl_artic;
using namespace fcl_artic::test;

TEST(References, AnObjectIsKeptAliveWhereItsOwnerIsGiven) {
  const std::shared_ptr<KinematicTree> tree = sliderTree({"rail", "cart"});
  ArticulatedCollisionManager manager(tree);
  const auto cart = ball(0.1);
  std::shared_ptr<fcl::CollisionObjectd> post = ball(0.1, {1, 0, 0});
  const std::weak_ptr<fcl::CollisionObjectd> watched = post;
  manager.bind(1, cart.get());
  EXPECT_EQ(cart.use_count(), 1);  // a pointer: the caller's
  manager.registerObject(post, "post");
  const fcl::CollisionObjectd* const pointer = post.get();
  post.reset();
  ASSERT_FALSE(watched.expired());
  manager.setup();
  EXPECT_FALSE(manager.isFree(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)));
  manager.unregisterObject(pointer);
  manager.setup();
  EXPECT_TRUE(watched.expired());
  EXPECT_TRUE(manager.isFree(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)));
}

TEST(References, ALinkIsGivenByNumberOrName) {
  const std::shared_ptr<KinematicTree> tree = sliderTree({"rail", "cart"});
  ArticulatedCollisionManager manager(tree);
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> balls;
  for (int i = 0; i < 5; ++i) balls.push_back(ball(0.1));
  const std::string name = "cart";
  manager.bind(0, balls[0]);  // the number, no null pointer
  manager.bind(LinkId{1}, balls[1]);
  manager.bind("cart", balls[2]);
  manager.bind(name, balls[3]);
  manager.bind(std::string_view("cart at once", 4), balls[4]);
  std::vector<LinkId> links;
  for (const auto& [link, object] : manager.boundObjects()) links.push_back(link);
  EXPECT_EQ(links, (std::vector<LinkId>{0, 1, 1, 1, 1}));
}

TEST(References, NoSuchLinkOrObjectIsRefusedByName) {
  const std::shared_ptr<KinematicTree> tree = sliderTree({"rail", "cart"});
  ArticulatedCollisionManager manager(tree);
  const auto object = ball(0.1);
  EXPECT_THROW(manager.bind(2, object), std::invalid_argument);
  EXPECT_THROW(manager.bind(-1, object), std::invalid_argument);
  EXPECT_THROW(manager.bind("card", object), std::invalid_argument);
  EXPECT_THROW(manager.bind("cart", std::shared_ptr<fcl::CollisionObjectd>()), std::invalid_argument);
  EXPECT_TRUE(manager.boundObjects().empty());
  EXPECT_EQ(object.use_count(), 1);
}

}  // namespace references_test
