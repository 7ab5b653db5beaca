#pragma once
// The instructions of the register machine. Operands a, b, c are slots of the present frame, if nothing else is said here.

// clang-format off
/// each(type name, C++ type): integers that wrap around at their own size.
#define CANOPUS_INTEGER_TYPES(each) \
  each(i8, std::int8_t) each(i16, std::int16_t) each(i32, std::int32_t) each(i64, std::int64_t) \
  each(u8, std::uint8_t) each(u16, std::uint16_t) each(u32, std::uint32_t) each(u64, std::uint64_t)

#define CANOPUS_INTEGER_OPCODES(type, _) \
  CANOPUS_EACH_OPCODE(add_##type)  /* a = b + c */ \
  CANOPUS_EACH_OPCODE(sub_##type)                  \
  CANOPUS_EACH_OPCODE(mul_##type)                  \
  CANOPUS_EACH_OPCODE(div_##type)  /* towards zero; error where c = 0 */ \
  CANOPUS_EACH_OPCODE(mod_##type)  /* sign of b; error where c = 0 */    \
  CANOPUS_EACH_OPCODE(neg_##type)  /* a = -b */    \
  CANOPUS_EACH_OPCODE(wrap_##type) /* a = the lowest bits of b, extended */

#define CANOPUS_REAL_OPCODES(type) \
  CANOPUS_EACH_OPCODE(add_##type) CANOPUS_EACH_OPCODE(sub_##type) CANOPUS_EACH_OPCODE(mul_##type)                  \
  CANOPUS_EACH_OPCODE(div_##type) /* error where c = 0 */ CANOPUS_EACH_OPCODE(neg_##type)                        \
  CANOPUS_EACH_OPCODE(eq_##type) CANOPUS_EACH_OPCODE(ne_##type) CANOPUS_EACH_OPCODE(lt_##type) CANOPUS_EACH_OPCODE(le_##type) \
  CANOPUS_EACH_OPCODE(round_##type) /* a = b as the integer type of `extra`, ties to even; error beyond its range */ \
  CANOPUS_EACH_OPCODE(trunc_##type) \
  CANOPUS_EACH_OPCODE(from_int_##type) CANOPUS_EACH_OPCODE(from_uint_##type)

/// Of no compiler: linked_code.cpp puts them in place of others. Operands b and c are a pointer to a device in memory or to BitOperands.
#define CANOPUS_LINKED_OPCODES \
  CANOPUS_EACH_OPCODE(load_bit)      /* a = the point */ \
  CANOPUS_EACH_OPCODE(store_bit)     /* the point = a */ \
  CANOPUS_EACH_OPCODE(load_bit_of_word)  /* a = bit `extra` of the word */ \
  CANOPUS_EACH_OPCODE(store_bit_of_word) \
  CANOPUS_EACH_OPCODE(load_u16) CANOPUS_EACH_OPCODE(load_i16) /* a = the word or words */ \
  CANOPUS_EACH_OPCODE(load_u32) CANOPUS_EACH_OPCODE(load_i32) CANOPUS_EACH_OPCODE(load_u64) \
  CANOPUS_EACH_OPCODE(store_16) CANOPUS_EACH_OPCODE(store_32) CANOPUS_EACH_OPCODE(store_64) \
  CANOPUS_EACH_OPCODE(bits_1) /* a and the bit behind the operands = what they give; `extra` instructions further */ \
  CANOPUS_EACH_OPCODE(bits_2) CANOPUS_EACH_OPCODE(bits_3) CANOPUS_EACH_OPCODE(bits_4) CANOPUS_EACH_OPCODE(bits_5) \
  CANOPUS_EACH_OPCODE(bits_6) CANOPUS_EACH_OPCODE(bits_7) CANOPUS_EACH_OPCODE(bits_8) \
  CANOPUS_EACH_OPCODE(load_store)    /* these and those behind them: the instructions that their names say, with their operands */ \
  CANOPUS_EACH_OPCODE(load_add_store) CANOPUS_EACH_OPCODE(load_sub_store) \
  CANOPUS_EACH_OPCODE(load_load_add_store) CANOPUS_EACH_OPCODE(load_load_sub_store) \
  CANOPUS_EACH_OPCODE(load_eq_move) CANOPUS_EACH_OPCODE(load_ne_move) CANOPUS_EACH_OPCODE(load_lt_move) \
  CANOPUS_EACH_OPCODE(load_le_move) \
  CANOPUS_EACH_OPCODE(load_bit_jump_unless) CANOPUS_EACH_OPCODE(load_bit_jump_if) \
  CANOPUS_EACH_OPCODE(move_move) CANOPUS_EACH_OPCODE(eq_jump_unless) CANOPUS_EACH_OPCODE(lt_jump_unless) \
  CANOPUS_EACH_OPCODE(element_address_store_at) CANOPUS_EACH_OPCODE(store_at_enter_block) CANOPUS_EACH_OPCODE(eq_bit_or) \
  CANOPUS_EACH_OPCODE(enter) /* call: the frame is a, the code begins at b and has c instructions */ \
  CANOPUS_EACH_OPCODE(enter_block) /* call_block: the frame is at [a] of the memory, the code as of enter */ \
  CANOPUS_EACH_OPCODE(on_delay) /* native, of TON */ CANOPUS_EACH_OPCODE(move_move_on_delay) \
  CANOPUS_EACH_OPCODE(element_address_load_at)

#define CANOPUS_OPCODES \
  CANOPUS_EACH_OPCODE(end)           /* of the program */ \
  CANOPUS_EACH_OPCODE(halt)          /* a break: in a machine's own copy of the code, in place of another instruction */ \
  CANOPUS_EACH_OPCODE(move)          /* a = b */ \
  CANOPUS_EACH_OPCODE(reset)         /* b slots from a on get their initial values */ \
  CANOPUS_EACH_OPCODE(reset_global)  /* b slots of the memory from a on get their initial values */ \
  CANOPUS_EACH_OPCODE(load_global)   /* a = slot b of the memory */ \
  CANOPUS_EACH_OPCODE(store_global)  /* slot a of the memory = b */ \
  CANOPUS_EACH_OPCODE(address)       /* a = place of slot b in the memory */ \
  CANOPUS_EACH_OPCODE(load_at)       /* a = the memory's slot [b] + c */ \
  CANOPUS_EACH_OPCODE(store_at)      /* the memory's slot [a] + c = b */ \
  CANOPUS_EACH_OPCODE(copy_at)       /* c slots of the memory from [b] on go to [a] on */ \
  CANOPUS_EACH_OPCODE(load_element)  /* a = element [b] of array c of the elements' table */ \
  CANOPUS_EACH_OPCODE(store_element) /* element [b] of array c = a */ \
  CANOPUS_EACH_OPCODE(element_address) /* a = place in the memory of element [b] of array c of the frame */ \
  CANOPUS_EACH_OPCODE(global_element_address) /* the same of an array whose offset is its place in the memory */ \
  CANOPUS_EACH_OPCODE(index_at)      /* a = a + place of element [b] in array c */ \
  CANOPUS_INTEGER_TYPES(CANOPUS_INTEGER_OPCODES) \
  CANOPUS_REAL_OPCODES(real) CANOPUS_REAL_OPCODES(lreal) \
  CANOPUS_EACH_OPCODE(real_to_lreal) CANOPUS_EACH_OPCODE(lreal_to_real) \
  CANOPUS_EACH_OPCODE(bit_and) CANOPUS_EACH_OPCODE(bit_or) CANOPUS_EACH_OPCODE(bit_xor) \
  CANOPUS_EACH_OPCODE(shl) CANOPUS_EACH_OPCODE(shr) /* a = b shifted by c; by 64 and more: 0 */ \
  CANOPUS_EACH_OPCODE(eq) CANOPUS_EACH_OPCODE(ne) CANOPUS_EACH_OPCODE(lt) CANOPUS_EACH_OPCODE(le) \
  CANOPUS_EACH_OPCODE(ltu) CANOPUS_EACH_OPCODE(leu)  /* without a sign */ \
  CANOPUS_EACH_OPCODE(jump)          /* c instructions further, as every jump */ \
  CANOPUS_EACH_OPCODE(loop)          /* back; counts towards the watchdog */ \
  CANOPUS_EACH_OPCODE(jump_if)       /* if a is not 0 */ \
  CANOPUS_EACH_OPCODE(jump_unless) \
  CANOPUS_EACH_OPCODE(jump_eq) CANOPUS_EACH_OPCODE(jump_ne) /* if a = b ... */ \
  CANOPUS_EACH_OPCODE(jump_lt) CANOPUS_EACH_OPCODE(jump_le) \
  CANOPUS_EACH_OPCODE(jump_ltu) CANOPUS_EACH_OPCODE(jump_leu) \
  CANOPUS_EACH_OPCODE(for_first)     /* if a is beyond limit b, as the sign of step b + 1 goes */ \
  CANOPUS_EACH_OPCODE(for_next)      /* a = a + step b + 1; back if not beyond limit b; counts towards the watchdog */ \
  CANOPUS_EACH_OPCODE(check_range)   /* error unless a is within range b of the elements' table */ \
  CANOPUS_EACH_OPCODE(call)          /* function a */ \
  CANOPUS_EACH_OPCODE(call_block)    /* the frame is at [a] of the memory, the code of function b */ \
  CANOPUS_EACH_OPCODE(return_) \
  CANOPUS_EACH_OPCODE(run_plugin)    /* one scan of it */ \
  CANOPUS_EACH_OPCODE(native)        /* function a of the natives' table, its result and arguments from b on */ \
  CANOPUS_EACH_OPCODE(native_at)     /* the same from [b] of the memory on */ \
  CANOPUS_EACH_OPCODE(read_device)   /* a = access b of the devices' table; with `extra` c is added to its number */ \
  CANOPUS_EACH_OPCODE(write_device)  /* access a of the devices' table = b; with `extra` the same */ \
  CANOPUS_LINKED_OPCODES
// clang-format on
