// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LoopbackServer_h
#define mammoray_LoopbackServer_h

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include <csignal>
#include <functional>

namespace mammoray::test
{
/**
 * A port of the loopback address where each connection is given to a function, one after another,
 * in a process of its own: what asks may fork, and the allocators of sanitizers do not bear that
 * beside a thread that allocates. Without a function nobody listens there.
 */
class LoopbackServer
{
public:
  explicit LoopbackServer(const std::function<void(int client)>& serve)
  {
    const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
    this->Port = ntohs(address.sin_port);
    if (serve)
    {
      EXPECT_EQ(listen(listener, 4), 0);
      this->Server = fork();
    }
    if (serve && this->Server == 0)
    {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      for (int client = 0; (client = accept(listener, nullptr, nullptr)) >= 0; close(client))
      {
        serve(client);
      }
      _exit(0);
    }
    close(listener);
  }
  ~LoopbackServer()
  {
    if (this->Server > 0)
    {
      kill(this->Server, SIGKILL);
      waitpid(this->Server, nullptr, 0);
    }
  }
  LoopbackServer(const LoopbackServer&) = delete;
  LoopbackServer& operator=(const LoopbackServer&) = delete;

  int Port = 0;

private:
  pid_t Server = 0;
};
}

#endif
