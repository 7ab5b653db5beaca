/* A PLC program in C, or in C that another compiler has made, as a shared object that the CPU of a plant runs:
 *
 *     gcc -O2 -shared -fPIC -o main.so main.c
 *     [[plc]]
 *     program = ["main.so"]                 and: canopus run --allow-native plant.toml
 *
 * The shared object has one function, canopus_program(), which returns a description of the program: a table of its variables and
 * the function for a scan. The variables stay where the program has them: Canopus writes their values before each scan, and reads
 * them behind it, so that clients read, write and force them by name, and RETAIN works as with every other program.
 *
 * Each PLC that names the file has variables of its own: the file is loaded once for each. It must not need another shared object
 * of its own folder. The program runs in the process of Canopus, with all rights of its user, on one thread at a time; it must
 * not block. What it does wrong with memory ends the whole run. So that runs repeat, it takes the time from now_ns alone.
 */
#ifndef CANOPUS_PROGRAM_H
#define CANOPUS_PROGRAM_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of this header. A program of another version is refused. */
#define CANOPUS_PROGRAM_ABI 1u

/* Types of IEC 61131-3, and what each is in C. */
enum {
  CANOPUS_BOOL = 0,    /* uint8_t, 0 or 1 */
  CANOPUS_SINT = 1,    /* int8_t */
  CANOPUS_INT = 2,     /* int16_t */
  CANOPUS_DINT = 3,    /* int32_t */
  CANOPUS_LINT = 4,    /* int64_t */
  CANOPUS_USINT = 5,   /* uint8_t */
  CANOPUS_UINT = 6,    /* uint16_t */
  CANOPUS_UDINT = 7,   /* uint32_t */
  CANOPUS_ULINT = 8,   /* uint64_t */
  CANOPUS_BYTE = 9,    /* uint8_t */
  CANOPUS_WORD = 10,   /* uint16_t */
  CANOPUS_DWORD = 11,  /* uint32_t */
  CANOPUS_LWORD = 12,  /* uint64_t */
  CANOPUS_REAL = 13,   /* float */
  CANOPUS_LREAL = 14,  /* double */
  CANOPUS_TIME = 15,   /* int64_t, ns */
  CANOPUS_DATE = 17,   /* int64_t, ns since 1970-01-01 */
  CANOPUS_TOD = 19,    /* int64_t, ns since midnight */
  CANOPUS_DT = 21,     /* int64_t, ns since 1970-01-01 */
  CANOPUS_STRING = 25  /* char[length + 1], ended by a 0 */
};

enum {
  CANOPUS_RETAIN = 1,   /* keeps its value over a power cut and STOP */
  CANOPUS_CONSTANT = 2, /* clients do not write it */
  CANOPUS_INPUT = 4,    /* has its device's value before each scan */
  CANOPUS_OUTPUT = 8    /* is written to its device behind each scan */
};

typedef struct canopus_variable {
  const char *name;    /* a letter or _, then letters, digits and _ */
  uint32_t type;       /* CANOPUS_INT ... */
  uint32_t count;      /* elements of an array from 0 on; 0: no array */
  uint32_t length;     /* of a STRING: its most characters, 1 to 1024; else 0 */
  uint32_t flags;      /* CANOPUS_RETAIN ... */
  void *value;         /* where it is; its initial value is what stands there behind the first start() */
  const char *device;  /* "X10", "D100", "U0\\G25": the first of its points or words, the lowest word first; NULL: none.
                          A BOOL needs a bit device; of the others those of 16 bits and more may be at either kind */
} canopus_variable;

/* Access to devices within a scan, for what cannot wait for its begin or end, as FROM and TO have it. */
typedef struct canopus_image {
  const void *owner;
  /* Reads the variable of that number in the table from its device. 0: done; 1: no such device or module, nothing has changed. */
  int (*read)(const struct canopus_image *image, uint32_t variable);
  /* The same the other way. */
  int (*write)(const struct canopus_image *image, uint32_t variable);
} canopus_image;

typedef struct canopus_program_info {
  uint32_t abi;  /* CANOPUS_PROGRAM_ABI */
  uint32_t variable_count;
  const canopus_variable *variables; /* of the table; it must not change */
  /* What is no variable of the table gets its initial value: when the program is loaded, with RUN and behind a power cut. The first
   * time this is so of the table's variables, too; later they are set by Canopus. NULL: there is nothing to do. */
  void (*start)(void);
  /* One scan. now_ns: the time of the plant at its begin. NULL: good; else why the CPU stops with an error, one line. */
  const char *(*scan)(const canopus_image *image, int64_t now_ns);
} canopus_program_info;

/* To be defined by the program. */
const canopus_program_info *canopus_program(void);

#ifdef __cplusplus
}
#endif

#endif
