// What the tests ask of errors: their kind, their form, and a part of their text.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

// The text of the Error that `call` throws: one line "<where>: <finding>; <remedy>". Fails the test
// when nothing or anything else is thrown.
inline std::string ErrorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(": "), std::string::npos) << text;
    EXPECT_NE(text.find("; "), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  } catch (const std::exception& other) {
    ADD_FAILURE() << "not an Error: " << other.what();
    return "";
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

#define EXPECT_ERROR(call, part)                                       \
  do {                                                                 \
    const std::string error_text = ErrorOf([&] { call; });             \
    EXPECT_NE(error_text.find(part), std::string::npos) << error_text; \
  } while (false)

// The text of the UsageError that `call` throws, one line. Fails the test when nothing or anything
// else is thrown.
inline std::string UsageErrorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const UsageError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  } catch (const std::exception& other) {
    ADD_FAILURE() << "not a UsageError: " << other.what();
    return "";
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

#define EXPECT_USAGE_ERROR(call, part)                                 \
  do {                                                                 \
    const std::string error_text = UsageErrorOf([&] { call; });        \
    EXPECT_NE(error_text.find(part), std::string::npos) << error_text; \
  } while (false)

}  // namespace colmap_seapoint
