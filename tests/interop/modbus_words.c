/* libmodbus as somebody's hands: modbus_words HOST PORT, then a line of the standard input each:
 * read ADDRESS COUNT -> the words; write ADDRESS WORD... -> ok. Addresses are decimal, words hexadecimal; a refusal is
 * "exception N". */
#include <errno.h>
#include <modbus/modbus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int refused(void) {
  if (errno <= MODBUS_ENOBASE) return -1;
  printf("exception %d\n", errno - MODBUS_ENOBASE);
  return 0;
}

static int serve(modbus_t *client, char *line) {
  uint16_t words[MODBUS_MAX_READ_REGISTERS] = {0};
  const char *what = strtok(line, " \n");
  const char *address = strtok(NULL, " \n");
  if (what == NULL || address == NULL) return -1;
  const int first = atoi(address);
  int count = 0;
  if (strcmp(what, "read") == 0) {
    const char *asked = strtok(NULL, " \n");
    count = asked == NULL ? 0 : atoi(asked);
    if (modbus_read_registers(client, first, count, words) != count) return refused();
    for (int i = 0; i < count; ++i) printf("%s%04X", i == 0 ? "" : " ", words[i]);
    puts("");
    return 0;
  }
  for (const char *word; count < MODBUS_MAX_WRITE_REGISTERS && (word = strtok(NULL, " \n")) != NULL; ++count)
    words[count] = (uint16_t)strtoul(word, NULL, 16);
  const int written =
      count == 1 ? modbus_write_register(client, first, words[0]) : modbus_write_registers(client, first, count, words);
  if (written != count) return refused();
  puts("ok");
  return 0;
}

int main(int count, char **arguments) {
  char line[1024];
  if (count != 3) return 2;
  modbus_t *client = modbus_new_tcp(arguments[1], atoi(arguments[2]));
  modbus_set_response_timeout(client, 60, 0); /* a PLC answers at once, a busy machine may not */
  if (modbus_connect(client) != 0) {
    perror("connect");
    return 1;
  }
  while (fgets(line, sizeof line, stdin) != NULL) {
    if (serve(client, line) != 0) {
      perror(line);
      return 1;
    }
    fflush(stdout);
  }
  modbus_close(client);
  modbus_free(client);
  return 0;
}
