#!/usr/bin/env node
// The smallest foreign client: reads one object over socketcand with nothing but a TCP socket.
// usage: socketcand_client.js HOST PORT BUS NODE [INDEX SUBINDEX [VALUE]]    (INDEX, SUBINDEX, VALUE hexadecimal)
'use strict';
const net = require('net');

const [host, port, bus, node, index = '1000', subIndex = '0', value] = process.argv.slice(2);
if (!node) throw new Error('usage: socketcand_client.js HOST PORT BUS NODE [INDEX SUBINDEX [VALUE]]');
const hex = (text, digits) => parseInt(text, 16).toString(16).toUpperCase().padStart(digits, '0');
const [low, high] = [hex(index, 4).slice(2), hex(index, 4).slice(0, 2)];
const request = (0x600 + Number(node)).toString(16);
const answer = (0x580 + Number(node)).toString(16).toUpperCase();

const end = (code, text) => { console.log(text); process.exit(code); };
setTimeout(() => end(1, 'no SDO answer within 60 s'), 60000);

const steps = {
  '< hi >': [`< open ${bus} >`, '< rawmode >', `< send ${request} 8 40 ${low} ${high} ${subIndex} 0 0 0 0 >`],
};
const socket = net.connect({ host, port, noDelay: true });
socket.on('error', (error) => end(1, String(error)));
socket.on('close', () => end(1, 'the server closed the connection'));
let text = '';
socket.on('data', (bytes) => {
  text += bytes;
  for (let close; (close = text.indexOf('>')) >= 0; text = text.slice(close + 1)) {
    const element = text.slice(0, close + 1);
    for (const line of steps[element] ?? []) socket.write(line);
    if (element.startsWith('< error')) end(1, element);
    const [, , identifier, , data = ''] = element.split(' ');
    if (!element.startsWith('< frame ') || identifier !== answer) continue;
    const read = data.match(/../g).slice(4).reverse().join('');
    if (!data.startsWith('4') || data.slice(2, 8) !== low + high + hex(subIndex, 2)) end(1, `not an answer to the read: ${data}`);
    if (value && parseInt(read, 16) !== parseInt(value, 16)) end(1, `${index}H:${subIndex} is ${read}H, expected ${value}H`);
    end(0, `node ${node}: ${index}H:${subIndex} is ${read}H`);
  }
});
