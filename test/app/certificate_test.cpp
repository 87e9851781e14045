// SPDX-License-Identifier: BSD-3-Clause
// check --certificate. (test/certificate has the verifier's answers to such files.)
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace certificate_test {

namespace {

using Json = nlohmann::json;

/// A ball at the end of a rail along x.
class CertificateOptionTest : public ProgramTest {
 protected:
  std::string rail() const {
    return write("rail.urdf", R"(<robot name='rail'><link name='base'/><link name='ball'><collision><geometry>
<sphere radius='0.1'/></geometry></collision></link><joint name='slide' type='prismatic'><parent link='base'/>
<child link='ball'/><axis xyz='1 0 0'/><limit lower='-9' upper='9' effort='1' velocity='1'/></joint></robot>)");
  }
  std::string wall() const {
    return write("wall.urdf", R"(<robot name='wall'><link name='wall'><collision><origin xyz='2 0 0'/><geometry>
<box size='0.1 1 1'/></geometry></collision></link></robot>)");
  }
  std::string path(const std::string& name) const { return write(name + ".old", "") + ".fac"; }
  static std::string read(const std::string& file) {
    std::stringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
};

TEST_F(CertificateOptionTest, WritesProofAndWorld) {
  const std::string file = path("free");
  const Outcome run =
      this->run("check " + rail() + " --scene " + wall() + " --from 0 --to 1 --json --certificate " + file);
  ASSERT_EQ(run.status, 0) << run.err;
  const Json answer = Json::parse(run.out);
  EXPECT_EQ(answer.at("certificate").at("proof_bytes"), 39);  // a hash and one direction
  EXPECT_EQ(read(file).substr(0, 4), "FAC2");
  EXPECT_EQ(read(file + ".world").substr(0, 18), "fcl_artic world 1\n");
}

// Counts and sizes are those of the files, and the command says which files the proof is about.
TEST_F(CertificateOptionTest, SaysWhatItWrote) {
  const std::string file = path("said"), robot = rail(), scene = wall(),
                    plan = write("my plan.csv", "time,slide\n0,0\n1,1\n2,0.5\n");
  const auto noteOf = [](const Outcome& run, const char* key) {
    const Json answer = Json::parse(run.out);
    std::string last;
    for (const Json& note : answer.at(key)) last = note.get<std::string>();
    return last;
  };
  const auto expected = [&](const std::string& files) {
    return "1 certificate, " + std::to_string(read(file).size()) + " bytes, in " + file + ", what it is about, " +
           std::to_string(read(file + ".world").size()) + " bytes, in " + file + ".world; fcl_artic_verify " + file +
           ".world " + file + " --urdf " + robot + " --scene " + scene + files + " proves it again";
  };
  const std::string world = robot + " --scene " + scene + " --json --certificate " + file;
  Outcome run = this->run("check " + world + " --from 0 --to 1");
  EXPECT_EQ(noteOf(run, "notes"), expected(" --from 0 --to 1")) << run.err;
  run = this->run("check " + world + " --trajectory '" + plan + "'");
  EXPECT_EQ(noteOf(run, "notes"), expected(" --plan '" + plan + "'")) << run.err;
  run = this->run("check " + world + " --trajectory '" + plan + "' --interpolation jtc-upsampled");
  EXPECT_EQ(noteOf(run, "notes"), expected(" --plan '" + plan + "' --interpolation jtc-upsampled")) << run.err;
  run = this->run("check " + world + " --trajectory '" + plan + "' --interpolation jtc-none");
  EXPECT_EQ(noteOf(run, "notes"), expected("")) << run.err;
  run = this->run("certify '" + plan + "' --robot " + world);
  EXPECT_EQ(noteOf(run, "notes"), expected(" --plan '" + plan + "'")) << run.err;
  // The verifier reads no other layouts: there is what was written.
  for (const char* log : {"Time,q1\n0,0\n1,1\n", "time;slide\n0;0\n1;1\n", "# time slide\n0 0\n1 1\n"}) {
    const std::string file_of_log = write("log.csv", log), safe = path("safe") + ".csv";
    run = this->run("certify " + file_of_log + " --robot " + world);
    EXPECT_EQ(noteOf(run, "notes"), expected("")) << run.err;
    run = this->run("check " + world + " --trajectory " + file_of_log);
    EXPECT_EQ(noteOf(run, "notes"), expected("")) << run.err;
    run = this->run("certify " + file_of_log + " --out " + safe + " --robot " + world);
    EXPECT_EQ(noteOf(run, "notes"), expected(" --plan " + safe)) << run.err;
  }
}

TEST_F(CertificateOptionTest, OfManyLinesThereIsARecordEach) {
  const std::string file = path("lines"), lines = write("lines.json",
                                                        "{\"from\": [0], \"to\": [1]}\n{\"from\": [0], \"to\": [3]}\n"
                                                        "{\"from\": [2], \"to\": [3]}\n{\"from\": [1], \"to\": [0]}\n");
  const Outcome run =
      this->run("check " + rail() + " --scene " + wall() + " --lines " + lines + " --certificate " + file);
  ASSERT_EQ(run.status, 1) << run.err;
  std::istringstream answers(run.out);
  std::size_t proofs = 0, missing = 0;
  for (std::string line; std::getline(answers, line);) {
    const Json certificate = Json::parse(line).at("certificate");
    proofs += certificate.contains("proof_bytes");
    missing += certificate.contains("missing");
  }
  EXPECT_EQ(proofs, 3u);
  EXPECT_EQ(missing, 1u);  // what touches from the beginning on
  const std::string records = read(file);
  std::size_t count = 0;
  for (std::size_t at = 0; (at = records.find("FAC2", at)) != std::string::npos; ++at) ++count;
  EXPECT_EQ(count, 3u);
}

TEST_F(CertificateOptionTest, NoFileIsLeftWithoutAProof) {
  const std::string file = write("none.fac", "FAC2 of another call");
  const Outcome run = this->run("check " + rail() + " --scene " + wall() + " --from 2 --to 3 --certificate " + file);
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_NE(run.out.find("no certificate: nothing is claimed: a certificate is about the time before a contact"),
            std::string::npos)
      << run.out;
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(file + ".world"));
}

TEST_F(CertificateOptionTest, AFolderThatIsNotThereIsAnError) {
  const Outcome run =
      this->run("check " + rail() + " --from 0 --to 1 --scene " + wall() + " --certificate /nowhere/at/all/x.fac");
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("/nowhere/at/all/x.fac.world"), std::string::npos) << run.err;
}

TEST_F(CertificateOptionTest, OfPlansThereIsARecordEach) {
  const std::string file = path("plans"),
                    plans = write("plans.jsonl",
                                  "{\"waypoints\": [[0], [1], [0.5]]}\n{\"waypoints\": [[0], [3]]}\n"
                                  "{\"waypoints\": [[0]]}\n");
  const Outcome run =
      this->run("certify " + plans + " --robot " + rail() + " --scene " + wall() + " --json --certificate " + file);
  ASSERT_EQ(run.status, 2) << run.err;
  const Json answer = Json::parse(run.out);
  EXPECT_TRUE(answer.at("plans").at(0).at("certificate").contains("proof_bytes"));
  EXPECT_TRUE(answer.at("plans").at(1).at("certificate").contains("proof_bytes"));  // until shortly before the contact
  EXPECT_NE(answer.at("notes").dump().find("of 3 plans 2 certificates, "), std::string::npos) << answer.at("notes");
  EXPECT_EQ(read(file).substr(0, 4), "FAC2");
  EXPECT_EQ(read(file + ".world").substr(0, 18), "fcl_artic world 1\n");
}

}  // namespace

}  // namespace certificate_test
