/* libmodbus against a rack with the usual map: modbus_libmodbus HOST PORT */
#include <errno.h>
#include <modbus/modbus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

static void check(const char *what, int held) {
  printf("%s  %s%s%s\n", held ? "ok  " : "FAIL", what, held ? "" : ": ", held ? "" : modbus_strerror(errno));
  failures += held ? 0 : 1;
}

static modbus_t *connected(const char *host, int port) {
  modbus_t *client = modbus_new_tcp(host, port);
  if (client == NULL) return NULL;
  modbus_set_response_timeout(client, 60, 0); /* a PLC answers at once, a busy machine may not */
  if (modbus_connect(client) == 0) return client;
  fprintf(stderr, "%s:%d: %s\n", host, port, modbus_strerror(errno));
  modbus_free(client);
  return NULL;
}

static void registers(modbus_t *client) {
  const uint16_t written[] = {1, 2, 65535};
  uint16_t read[MODBUS_MAX_READ_REGISTERS] = {0};
  check("16 writes D730 to D732", modbus_write_registers(client, 730, 3, written) == 3);
  check("3 reads them back", modbus_read_registers(client, 730, 3, read) == 3 && memcmp(read, written, 6) == 0);
  check("6 writes D731", modbus_write_register(client, 731, 0x12) == 1);
  check("22 changes bits of it", modbus_mask_write_register(client, 731, 0xF2, 0x25) == 1);
  check("3 reads 17H", modbus_read_registers(client, 731, 1, read) == 1 && read[0] == 0x17);
  check("23 writes D740 to D741 and reads D739 to D741",
        modbus_write_and_read_registers(client, 740, 2, written, 739, 3, read) == 3 && read[1] == 1 && read[2] == 2);
  check("3 reads 125 registers", modbus_read_registers(client, 0, 125, read) == 125);
  check("4 reads SD203", modbus_read_input_registers(client, 203, 1, read) == 1 && read[0] == 0);
}

static void bits(modbus_t *client) {
  const uint8_t written[] = {1, 0, 1};
  uint8_t read[MODBUS_MAX_READ_BITS] = {0};
  check("15 writes Y130 to Y132", modbus_write_bits(client, 0x130, 3, written) == 3);
  check("1 reads them back", modbus_read_bits(client, 0x130, 3, read) == 3 && memcmp(read, written, 3) == 0);
  check("5 turns Y130 off", modbus_write_bit(client, 0x130, 0) == 1);
  check("1 reads it back", modbus_read_bits(client, 0x130, 1, read) == 1 && read[0] == 0);
  check("1 reads 2000 coils", modbus_read_bits(client, 0, 2000, read) == 2000);
  check("2 reads X0 to X1F", modbus_read_input_bits(client, 0, 32, read) == 32);
}

static void refusals(modbus_t *client) {
  uint16_t word = 0;
  uint8_t bit = 0;
  uint8_t id[MODBUS_MAX_PDU_LENGTH];
  const uint8_t no_points[] = {0xFF, 0x03, 0, 0, 0, 0};
  uint8_t reply[MODBUS_TCP_MAX_ADU_LENGTH];
  errno = 0;
  check("65000 is no register: exception 02", modbus_read_registers(client, 65000, 1, &word) == -1 && errno == EMBXILADD);
  check("50000 is no coil: exception 02", modbus_write_bit(client, 50000, 1) == -1 && errno == EMBXILADD);
  check("50000 is no input: exception 02", modbus_read_input_bits(client, 50000, 1, &bit) == -1 && errno == EMBXILADD);
  check("17 is no function here: exception 01", modbus_report_slave_id(client, sizeof id, id) == -1 && errno == EMBXILFUN);
  modbus_send_raw_request(client, (uint8_t *)no_points, sizeof no_points);
  check("no points: exception 03", modbus_receive_confirmation(client, reply) == 9 && reply[7] == 0x83 && reply[8] == 3);
  check("and the connection goes on", modbus_read_registers(client, 730, 1, &word) == 1 && word == 1);
}

int main(int count, char **arguments) {
  if (count != 3) return 2;
  modbus_t *client = connected(arguments[1], atoi(arguments[2]));
  modbus_t *other = connected(arguments[1], atoi(arguments[2]));
  if (client == NULL || other == NULL) return 1;
  registers(client);
  bits(client);
  refusals(client);
  uint16_t word = 0;
  check("a second client reads what the first one wrote", modbus_read_registers(other, 732, 1, &word) == 1 && word == 65535);
  modbus_close(client);
  check("and goes on when that one has left", modbus_read_registers(other, 730, 1, &word) == 1 && word == 1);
  modbus_close(other);
  modbus_free(client);
  modbus_free(other);
  puts(failures == 0 ? "all held" : "some failed");
  return failures == 0 ? 0 : 1;
}
