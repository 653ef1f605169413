// SPDX-License-Identifier: BSD-3-Clause
// The SHA-256 of bytes that come in pieces (FIPS 180-4, computed by libcrypto).
#pragma once

#include <cstddef>
#include <memory>
#include <string>

struct evp_md_ctx_st;  // libcrypto's EVP_MD_CTX

namespace sepcal::files {

class Sha256 {
 public:
  Sha256();  // throws Error where libcrypto offers no SHA-256

  void absorb(const char* bytes, std::size_t count);

  /// 64 lower-case hexadecimal digits of all that was absorbed. Ends the hash: call it once.
  std::string finish();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

}  // namespace sepcal::files
