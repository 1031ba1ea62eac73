// Read by the proxy before it starts. Its connections to the hub's socket stay open, as those to addresses do.
// At the end of a request Node.js writes nothing, literally, and that fails where the hub has answered and closed
// already: some in a hundred logins got "503" (EPIPE, https://github.com/nodejs/node/issues/40553).
const http = require('node:http');

const agent = new http.Agent({ keepAlive: true });
const { request } = http;

http.request = (options, ...others) => {
  if (options.socketPath && options.headers?.connection === 'close') {
    options.headers.connection = 'keep-alive';
    options.agent = agent;
  }
  return request(options, ...others);
};
