// The merging rules of the client's picture: whatever order the network delivers, the newest news of each body stands.
#include "tumble/picture.h"

#include <gtest/gtest.h>

#include "protocol/packed.h"
#include "tumble/contacts.h"
#include "unit/client/messages.h"

namespace tumble::client {
namespace {

class PictureTest : public testing::Test {
 protected:
  PictureTest() {
    picture.merge(make_catalog({{0, "floor"}, {1, "ball"}}));
    picture.merge(make_state(0, {{0, 0.0}, {1, 1.0}}));
  }
  double height(std::string_view name) const { return picture.find(name)->position[2]; }

  Picture picture;
};

TEST(Picture, IsCompleteWhenEveryBodyIsDescribedAndPlaced) {
  Picture picture;
  EXPECT_FALSE(picture.is_complete());
  picture.merge(make_state(0, {{0, 0.0}, {1, 1.0}}));
  EXPECT_FALSE(picture.is_complete());
  picture.merge(make_catalog({{0, "floor"}, {1, "ball"}}));
  EXPECT_TRUE(picture.is_complete());
}

TEST_F(PictureTest, ABodyThatIsNotMentionedStays) {
  state_t message = make_state(3, {{1, 1.5}});
  message.num_bodies = 2;
  picture.merge(message);
  EXPECT_EQ(height("floor"), 0.0);
  EXPECT_EQ(height("ball"), 1.5);
  EXPECT_EQ(picture.step(), 3);
  EXPECT_TRUE(picture.is_complete());
}

TEST_F(PictureTest, AnOlderStepThatComesLateOnlyFillsGaps) {
  picture.merge(make_state(9, {{1, 5.0}}));
  picture.merge(make_state(8, {{0, 2.0}, {1, 4.0}}));
  EXPECT_EQ(height("ball"), 5.0);
  EXPECT_EQ(height("floor"), 2.0);  // of this body step 8 is the newest news
  EXPECT_EQ(picture.step(), 9);
}

TEST(Picture, ChunksOfOneStepComeInAnyOrder) {
  Picture picture;
  picture.merge(make_catalog({{0, "a"}, {1, "b"}, {2, "c"}}));
  for (const std::int16_t chunk : {2, 0, 1}) {
    state_t message = make_state(4, {{chunk, 10.0 + chunk}});
    message.chunk = chunk;
    message.num_chunks = message.num_bodies = 3;
    EXPECT_FALSE(picture.is_complete());
    picture.merge(message);
  }
  EXPECT_EQ(picture.find("a")->position[2], 10.0);
  EXPECT_EQ(picture.find("c")->position[2], 12.0);
  EXPECT_TRUE(picture.is_complete());
}

TEST_F(PictureTest, ANewerEpochRemovesWhatItDoesNotList) {
  catalog_t message = make_catalog({{0, "floor"}});
  message.epoch = 1;
  message.id_limit = message.end_id = 2;
  picture.merge(message);
  EXPECT_EQ(picture.find("ball"), nullptr);
  EXPECT_TRUE(picture.is_complete());
  // A state of before the removal, overtaken on the way, doesn't bring it back.
  picture.merge(make_state(1, {{0, 0.0}, {1, 1.0}}));
  EXPECT_EQ(picture.find(1), nullptr);
  EXPECT_TRUE(picture.is_complete());
}

TEST_F(PictureTest, ACatalogSpeaksOnlyOfItsRange) {
  catalog_t message = make_catalog({});
  message.epoch = 1;
  message.num_bodies = 2;
  message.first_id = 2;
  message.id_limit = message.end_id = 5;
  picture.merge(message);
  EXPECT_NE(picture.find("ball"), nullptr);
}

TEST_F(PictureTest, ANewGenerationIsANewBody) {
  state_t newer = make_state(5, {{1, 3.0}});
  newer.generation = {1};
  newer.catalog_epoch = 1;
  picture.merge(newer);
  EXPECT_EQ(picture.find("ball"), nullptr);  // its description was of the one before
  state_t older = make_state(6, {{1, 9.0}});
  older.catalog_epoch = 1;
  picture.merge(older);
  catalog_t description = make_catalog({{1, "cube"}});
  description.generation = {1};
  description.epoch = 1;
  description.first_id = 1;
  picture.merge(description);
  EXPECT_EQ(height("cube"), 3.0);
}

TEST_F(PictureTest, ANewSessionStartsFromNothingAndStragglersAreIgnored) {
  state_t restarted = make_state(0, {{0, 1.0}});
  restarted.session = 2;
  restarted.utime = 5000;
  EXPECT_TRUE(picture.merge(restarted));
  EXPECT_EQ(picture.session(), 2);
  EXPECT_EQ(picture.find("ball"), nullptr);
  EXPECT_FALSE(picture.merge(make_state(900, {{0, 7.0}, {1, 7.0}})));  // session 1, older clock
  EXPECT_EQ(picture.session(), 2);
  EXPECT_EQ(picture.bodies().size(), 1u);
}

TEST_F(PictureTest, AnOlderEpochOfTheCatalogSaysNothing) {
  catalog_t message = make_catalog({{0, "floor"}, {1, "ball"}, {2, "cone"}});
  message.epoch = 2;
  picture.merge(message);
  EXPECT_FALSE(picture.merge(make_catalog({{0, "floor"}})));
  EXPECT_NE(picture.find("cone"), nullptr);
}

TEST_F(PictureTest, ShapesAndVerticesOfABodyMayComeInLaterMessages) {
  catalog_t body = make_catalog({{1, "ball"}});
  body.epoch = 1;
  body.num_bodies = 2;
  body.generation = {1};
  body.body_shapes = {2};
  body.first_id = 1;
  body.shape_type = {catalog_t::SHAPE_HULL};
  body.shape_vertices = {2};
  picture.merge(body);
  state_t place = make_state(1, {{0, 0.0}, {1, 0.0}});
  place.generation = {0, 1};
  place.catalog_epoch = 1;
  picture.merge(place);
  EXPECT_FALSE(picture.is_complete());  // a shape and two vertices are missing

  catalog_t more = body;
  more.first_id = more.end_id = 0;
  more.id.clear();
  more.shape_number = {1};
  more.shape_type = {catalog_t::SHAPE_SPHERE};
  more.shape_vertices = {0};
  picture.merge(more);
  EXPECT_FALSE(picture.is_complete());  // the vertices still are
  for (const std::int32_t number : {1, 0}) {
    catalog_t vertex = make_catalog({});
    vertex.epoch = 1;
    vertex.num_bodies = 2;
    vertex.vertex_body = {1};
    vertex.vertex_shape = {0};
    vertex.vertex_number = {number};
    vertex.vertex_x = {static_cast<float>(number)};
    vertex.vertex_y = vertex.vertex_z = {0.0f};
    picture.merge(vertex);
  }
  EXPECT_TRUE(picture.is_complete());
  EXPECT_EQ(picture.find("ball")->shapes[0].vertices[1][0], 1.0f);
}

TEST(ClientPicture, KnowsWhetherAPublicationIsWhole) {
  Picture picture;
  state_t first = make_state(7, {{0, 1.0}}), second = make_state(7, {{1, 2.0}});
  first.num_chunks = second.num_chunks = 2;
  second.chunk = 1;
  picture.merge(first);
  picture.merge(first);  // repeated by the network
  EXPECT_EQ(picture.whole_step(), -1);
  picture.merge(second);
  EXPECT_EQ(picture.whole_step(), 7);
  first.step = second.step = 8;
  first.utime = 5000;
  second.utime = 6000;  // of the publication after: between them one message each was lost
  picture.merge(first);
  picture.merge(second);
  EXPECT_EQ(picture.step(), 8);
  EXPECT_EQ(picture.whole_step(), 7);
}

TEST(ClientPicture, TakesPackedBodiesThatTheCatalogueKnows) {
  Picture picture;
  catalog_t catalog = make_catalog({{0, "floor"}, {1, "ball"}});
  catalog.generation = {1, 35};
  catalog.type = {catalog_t::TYPE_STATIC, catalog_t::TYPE_DYNAMIC};
  packed_t message{};
  message.utime = 2000;
  message.session = 1;
  message.step = 3;
  message.num_bodies = 2;
  message.num_chunks = 1;
  message.edge = kPackedEdge;
  message.n = 3;
  message.records.resize(3 * kPackedRecord);
  message.size = static_cast<std::int32_t>(message.records.size());
  const std::uint32_t generations[] = {1, 35, 1};
  for (std::uint32_t id = 0; id < 3; ++id) {
    PackedBody body;
    body.id = id;
    body.generation = generations[id];
    body.values = {0.0, 0.0, 2.0 * id, 1.0, 0.0, 0.0, 0.0};
    pack_body(body, message, PackedRecord(message.records.data() + id * kPackedRecord, kPackedRecord));
  }
  picture.merge(message);
  EXPECT_TRUE(picture.bodies().empty()) << "whose they are is not known yet";
  picture.merge(catalog);
  message.utime = 3000;
  picture.merge(message);
  EXPECT_TRUE(picture.is_complete());
  EXPECT_EQ(picture.bodies().size(), 2u);
  EXPECT_TRUE(picture.find("floor")->is_static());
  EXPECT_EQ(picture.find("ball")->generation, 35);
  EXPECT_NEAR(picture.find("ball")->position[2], 2.0, 1e-4);
}

TEST(ClientContacts, GathersTheMessagesOfAStep) {
  Contacts contacts;
  contacts_t part{};
  part.session = 1;
  part.utime = 10;
  part.step = 4;
  part.num_contacts = 2;
  part.num_chunks = 2;
  part.n = 1;
  part.body_a = {3};
  part.body_b = {5};
  part.px = part.py = part.pz = part.nx = part.ny = part.nz = part.separation = part.jx = part.jy =
      part.jz = {0.5};
  contacts.merge(part);
  contacts.merge(part);  // repeated by the network
  EXPECT_EQ(contacts.all.size(), 1u);
  EXPECT_FALSE(contacts.complete);
  part.chunk = 1;
  contacts.merge(part);
  EXPECT_TRUE(contacts.complete);
  EXPECT_EQ(contacts.all[1].body_b, 5);
  part.utime = 9;  // overtaken
  contacts.merge(part);
  EXPECT_EQ(contacts.all.size(), 2u);
}

}  // namespace
}  // namespace tumble::client
