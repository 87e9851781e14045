(* SPDX-License-Identifier: BSD-3-Clause *)
(** * Numbers, axes and poses of the files as models *)
From Coq Require Import Reals ZArith Lia Lra Bool List.
From FclArtic Require Import Statement Numbers Trig Frames.
Import ListNotations.
Open Scope R_scope.

(** ** Numbers *)

(** Exact from 2^-64 on; smaller units are rounded down. *)
Definition enclose (x : number) : Z * Z :=
  let e := (exponent x + 64)%Z in
  if Z.leb 0 e then (Z.shiftl (mantissa x) e, 0%Z) else (Z.shiftr (mantissa x) (- e), 1%Z).
Definition tm_number (x : number) : tm := let (c, r) := enclose x in const c r.
Definition number_up (x : number) : Z := let (c, r) := enclose x in (c + r)%Z.

Lemma two_power k : (0 <= k)%Z -> IZR (2 ^ k) = powerRZ 2 k.
Proof.
  intros H. rewrite <- (Z2Nat.id k H). rewrite <- pow_powerRZ, <- pow_IZR. reflexivity.
Qed.

Lemma power_opp k : powerRZ 2 (- k) = / powerRZ 2 k.
Proof.
  assert (powerRZ 2 k <> 0) by (apply powerRZ_NOR; lra).
  apply Rmult_eq_reg_r with (powerRZ 2 k); [|assumption].
  rewrite <- powerRZ_add by lra. rewrite Z.add_opp_diag_l, Rinv_l by assumption. reflexivity.
Qed.

Lemma power_ulp e : powerRZ 2 e = powerRZ 2 (e + 64) * ulp.
Proof.
  rewrite powerRZ_add by lra. rewrite <- (two_power 64) by lia. change (2 ^ 64)%Z with one.
  rewrite Rmult_assoc, (Rmult_comm (IZR one)), ulp_one. ring.
Qed.

Lemma enclose_ok x : Rabs (real x - V (fst (enclose x))) <= V (snd (enclose x)).
Proof.
  unfold enclose, real. rewrite power_ulp. destruct (Z.leb_spec 0 (exponent x + 64)) as [P|N]; cbn [fst snd].
  - rewrite Z.shiftl_mul_pow2 by exact P. unfold V. rewrite mult_IZR, two_power by exact P.
    rewrite <- Rmult_assoc. unfold Rminus. rewrite Rplus_opp_r, Rabs_R0. lra.
  - set (k := (- (exponent x + 64))%Z). replace (exponent x + 64)%Z with (- k)%Z by (unfold k; lia).
    pose proof (shiftr_err (mantissa x) k ltac:(lia)) as E. rewrite two_power in E by lia.
    rewrite power_opp, (V_ulps 1).
    replace (IZR (mantissa x) * (/ powerRZ 2 k * ulp)) with (V (mantissa x) / powerRZ 2 k) by (unfold V, Rdiv; ring).
    apply Rabs_le. lra.
Qed.

Lemma holds_number s x : holds (tm_number x) s (real x).
Proof. unfold tm_number. pose proof (enclose_ok x) as H. destruct (enclose x). apply holds_const. exact H. Qed.
Lemma number_up_ok x : real x <= V (number_up x).
Proof.
  unfold number_up. pose proof (enclose_ok x) as H. destruct (enclose x) as [c r]. cbn [fst snd] in H.
  rewrite V_add. apply abs_in in H. lra.
Qed.

Definition number_down (x : number) : Z := let (c, r) := enclose x in (c - r)%Z.
Lemma number_down_ok x : V (number_down x) <= real x.
Proof.
  unfold number_down. pose proof (enclose_ok x) as H. destruct (enclose x) as [c r]. cbn [fst snd] in H.
  rewrite V_sub. apply abs_in in H. lra.
Qed.

Definition tm_point (p : numbers3) : tvec := Tvec (tm_number (n1 p)) (tm_number (n2 p)) (tm_number (n3 p)).
Lemma holdsv_point s p : holdsv (tm_point p) s (point p).
Proof. repeat split; apply holds_number. Qed.

(** With entries that may be off by r more. *)
Definition twiden (v : tvec) (r : Z) : tvec := Tvec (widen (tx v) r) (widen (ty v) r) (widen (tz v) r).
Lemma holdsv_widen s v r e x y : holdsv v s x -> near e y x -> e <= V r -> holdsv (twiden v r) s y.
Proof.
  intros (A & B & C) (E & F & G) H. repeat split; (eapply holds_widen; [eassumption | lra]).
Qed.

Lemma power_neg k : (0 <= k <= 64)%Z -> / 2 ^ Z.to_nat k = V (2 ^ (64 - k)).
Proof.
  intros H. unfold V. rewrite two_power by lia. unfold Z.sub. rewrite Z.add_comm, powerRZ_add by lra.
  rewrite Rmult_assoc. replace (powerRZ 2 64) with (IZR one) by (rewrite <- two_power; [reflexivity | lia]).
  rewrite (Rmult_comm _ ulp), ulp_one, Rmult_1_r. rewrite power_opp.
  rewrite <- (Z2Nat.id k) at 2 by lia. rewrite <- pow_powerRZ. reflexivity.
Qed.

(** ** Poses *)

Definition rotated (a b c : numbers3) (p : tvec) : step :=
  let row r := twiden (tm_point r) (2 ^ 15) in Placed (row a) (row b) (row c) p.
Definition placed (p : stated_pose) : step := rotated (r1 p) (r2 p) (r3 p) (tm_point (shift p)).

Lemma rotated_ok s a b c m pm p M : rotation_means a b c m -> holdsv pm s p -> (forall x, M x = add (apply m x) p) ->
  holds_step s (rotated a b c pm) M.
Proof.
  intros (R & N1 & N2 & N3) Hp E.
  assert (E49 : / 2 ^ 49 <= V (2 ^ 15)) by (pose proof (power_neg 49 ltac:(lia)) as K; apply Req_le; exact K).
  apply holds_placed with (m := m) (p := p); try exact R; try exact E; try exact Hp;
    (eapply holdsv_widen; [apply holdsv_point | eassumption | exact E49]).
Qed.

Lemma placed_ok s p M : pose_map p M -> holds_step s (placed p) M.
Proof. intros [m R]. eapply rotated_ok; [exact R | apply holdsv_point | reflexivity]. Qed.

(** ** Axes

    With a common exponent an axis is a vector of integers A; the unit vector along it is A / sqrt (A.A). *)
Definition unit_entry (a n : Z) : Z := (a * 2 ^ 144 / Z.sqrt (n * 2 ^ 160))%Z.

Lemma unit_entry_ok a n : (0 < n)%Z -> (a * a <= n)%Z -> Rabs (IZR a / sqrt (IZR n) - V (unit_entry a n)) <= V 2.
Proof.
  intros Hn Ha. unfold unit_entry. set (l := Z.sqrt (n * 2 ^ 160)).
  pose proof (Z.sqrt_spec (n * 2 ^ 160) ltac:(lia)) as [L U]. fold l in L, U.
  assert (L80 : (2 ^ 80 <= l)%Z).
  { unfold l. rewrite <- (Z.sqrt_square (2 ^ 80)) by lia. apply Z.sqrt_le_mono. lia. }
  assert (Hl : (0 < l)%Z) by lia.
  destruct (floor_div (a * 2 ^ 144) l Hl) as [F1 F2]. set (q := (a * 2 ^ 144 / l)%Z) in *.
  assert (RL : 0 < IZR l) by (apply IZR_lt; lia).
  assert (RN : 0 < IZR n) by (apply IZR_lt; lia).
  set (r := sqrt (IZR n)). assert (Rr : 0 < r) by (apply sqrt_lt_R0; exact RN).
  assert (Rsq : r * r = IZR n) by (apply sqrt_sqrt; lra).
  set (k := IZR (2 ^ 80)). assert (Kk : k * k = IZR (2 ^ 160)) by (unfold k; rewrite <- mult_IZR; reflexivity).
  assert (K0 : 0 < k) by (apply IZR_lt; reflexivity).
  (* l <= sigma < l + 1 *)
  set (sigma := r * k). assert (S0 : 0 < sigma) by (apply Rmult_lt_0_compat; assumption).
  assert (S2 : sigma * sigma = IZR (n * 2 ^ 160)).
  { rewrite mult_IZR, <- Kk, <- Rsq. unfold sigma. ring. }
  assert (S1 : IZR l <= sigma).
  { apply Rsqr_incr_0_var; [|lra]. unfold Rsqr. rewrite S2, <- mult_IZR. apply IZR_le. lia. }
  assert (S3 : sigma < IZR l + 1).
  { apply Rsqr_incrst_0; [|lra|lra]. unfold Rsqr. rewrite S2, <- plus_IZR, <- mult_IZR. apply IZR_lt. lia. }
  set (x := IZR a / r). set (X := x * IZR one).
  assert (Hx : Rabs x <= 1).
  { apply Rabs_le.
    assert (x * x <= 1).
    { unfold x, Rdiv. replace (IZR a * / r * (IZR a * / r)) with (IZR (a * a) * / (r * r)) by (rewrite mult_IZR; field; lra).
      rewrite Rsq. apply Rmult_le_reg_r with (IZR n); [exact RN|]. rewrite Rmult_assoc, Rinv_l by lra.
      rewrite Rmult_1_r, Rmult_1_l. apply IZR_le. exact Ha. }
    nra. }
  assert (O1 : IZR one <= IZR l) by (apply IZR_le; unfold one; lia).
  assert (O0 : 0 < IZR one) by (apply IZR_lt; reflexivity).
  assert (HX : Rabs X <= IZR l).
  { unfold X. rewrite Rabs_mult, (Rabs_right (IZR one)) by lra.
    eapply Rle_trans; [apply Rmult_le_compat_r; [lra | exact Hx]|]. lra. }
  assert (XS : X * sigma = IZR (a * 2 ^ 144)).
  { unfold X, sigma, x, k. rewrite mult_IZR. change (2 ^ 144)%Z with (one * 2 ^ 80)%Z. rewrite mult_IZR. field. lra. }
  assert (XE : Rabs (X * (sigma - IZR l)) <= IZR l).
  { rewrite Rabs_mult, (Rabs_right (sigma - _)) by lra.
    eapply Rle_trans; [|exact HX]. rewrite <- (Rmult_1_r (Rabs X)) at 2.
    apply Rmult_le_compat_l; [apply Rabs_pos | lra]. }
  assert (Q : Rabs (X - IZR q) <= 2).
  { rewrite <- XS in F1, F2. apply abs_in in XE.
    assert (G1 : IZR q * IZR l <= X * sigma).
    { apply Rmult_le_compat_r with (r := IZR l) in F1; [|lra]. unfold Rdiv in F1.
      rewrite Rmult_assoc, Rinv_l, Rmult_1_r in F1 by lra. exact F1. }
    assert (G2 : X * sigma <= (IZR q + 1) * IZR l).
    { apply Rlt_le, Rmult_le_compat_r with (r := IZR l) in F2; [|lra]. unfold Rdiv in F2.
      rewrite Rmult_assoc, Rinv_l, Rmult_1_r in F2 by lra. exact F2. }
    assert (E : X * sigma = X * IZR l + X * (sigma - IZR l)) by ring. rewrite E in G1, G2.
    apply Rabs_le. split; apply Rmult_le_reg_r with (IZR l); try exact RL; lra. }
  replace (x - V q) with ((X - IZR q) * ulp).
  - rewrite Rabs_mult, (Rabs_right ulp) by (left; apply ulp_pos). rewrite (V_ulps 2).
    apply Rmult_le_compat_r; [left; apply ulp_pos | exact Q].
  - unfold X, V. rewrite Rmult_minus_distr_r, Rmult_assoc, (Rmult_comm (IZR one)), ulp_one. ring.
Qed.

Definition aligned (e : Z) (x : number) : Z := (mantissa x * 2 ^ (exponent x - e))%Z.

(** Whether an axis is 0 or has two numbers that are 0, and its entries. *)
Definition axis_tm (a : numbers3) : tvec :=
  let e := Z.min (exponent (n1 a)) (Z.min (exponent (n2 a)) (exponent (n3 a))) in
  let x := aligned e (n1 a) in let y := aligned e (n2 a) in let z := aligned e (n3 a) in
  let n := (x * x + y * y + z * z)%Z in
  if (Z.eqb x 0 && Z.eqb y 0) || (Z.eqb x 0 && Z.eqb z 0) || (Z.eqb y 0 && Z.eqb z 0) then
    Tvec (const (Z.sgn x * one) 0) (const (Z.sgn y * one) 0) (const (Z.sgn z * one) 0)
  else
    let entry c := const (unit_entry c n) (2 + 2 ^ 14) in
    Tvec (entry x) (entry y) (entry z).

Lemma real_aligned e x : (e <= exponent x)%Z -> real x = powerRZ 2 e * IZR (aligned e x).
Proof.
  intros H. unfold real, aligned. rewrite mult_IZR, two_power by lia.
  replace (exponent x) with (e + (exponent x - e))%Z at 1 by lia. rewrite powerRZ_add by lra. ring.
Qed.

Lemma norm_scale c v : 0 < c -> norm (scale c v) = c * norm v.
Proof.
  intros H. unfold norm. replace (dot (scale c v) (scale c v)) with (c * c * dot v v) by (unfold dot, scale; cbn; ring).
  rewrite sqrt_mult_alt by (apply Rmult_le_pos; lra). rewrite sqrt_square by lra. reflexivity.
Qed.

Lemma sgn_div x : x <> 0%Z -> IZR x / sqrt (IZR (x * x)) = IZR (Z.sgn x).
Proof.
  intros H. rewrite mult_IZR. change (IZR x * IZR x) with (Rsqr (IZR x)). rewrite sqrt_Rsqr_abs.
  assert (IZR x <> 0) by (apply not_0_IZR; exact H).
  destruct (Z.lt_trichotomy x 0) as [L|[E|G]]; [|lia|].
  - rewrite Rabs_left by (apply IZR_lt; exact L). rewrite Z.sgn_neg by exact L. field. assumption.
  - rewrite Rabs_right by (left; apply Rlt_gt, IZR_lt; exact G). rewrite Z.sgn_pos by exact G. field. assumption.
Qed.

Lemma holds_sgn s x : holds (const (Z.sgn x * one) 0) s (IZR (Z.sgn x)).
Proof.
  eapply holds_eq; [|apply holds_exact]. unfold V. rewrite mult_IZR, Rmult_assoc, (Rmult_comm (IZR one)), ulp_one. ring.
Qed.

Lemma axis_ok s a k : axis_means (point a) k -> holdsv (axis_tm a) s k.
Proof.
  intros (K & N & C). unfold axis_tm.
  set (e := Z.min _ _). set (x := aligned e (n1 a)). set (y := aligned e (n2 a)). set (z := aligned e (n3 a)).
  set (n := (x * x + y * y + z * z)%Z).
  set (c := powerRZ 2 e). assert (Hc : 0 < c) by (apply powerRZ_lt; lra).
  set (A := Vec (IZR x) (IZR y) (IZR z)).
  assert (EA : point a = scale c A).
  { unfold point, scale, A, x, y, z, c; cbn. f_equal; apply real_aligned; unfold e; lia. }
  assert (EN : norm A = sqrt (IZR n)).
  { unfold norm, A, dot, n; cbn. rewrite !plus_IZR, !mult_IZR. reflexivity. }
  assert (U : scale (/ norm (point a)) (point a) = scale (/ sqrt (IZR n)) A).
  { rewrite EA, norm_scale by exact Hc. rewrite EN. unfold scale; cbn.
    destruct (Req_dec (sqrt (IZR n)) 0) as [Z0|NZ].
    - assert (IZR n = 0) by (apply sqrt_eq_0; [apply IZR_le; unfold n; nia | exact Z0]).
      assert (n = 0%Z) by (apply eq_IZR; assumption).
      assert (x = 0 /\ y = 0 /\ z = 0)%Z as (-> & -> & ->) by (unfold n in *; nia). f_equal; ring.
    - f_equal; field; split; lra. }
  rewrite U in N, C.
  destruct ((Z.eqb x 0 && Z.eqb y 0) || (Z.eqb x 0 && Z.eqb z 0) || (Z.eqb y 0 && Z.eqb z 0)) eqn:B.
  - rewrite !orb_true_iff, !andb_true_iff, !Z.eqb_eq in B.
    assert (CA : coordinate_axis (point a)).
    { rewrite EA. unfold coordinate_axis, scale, A; cbn [vx vy vz].
      destruct B as [[[-> ->]|[-> ->]]|[-> ->]]; [left | right; left | right; right]; split; ring. }
    rewrite (C CA). unfold scale, A; cbn [vx vy vz].
    assert (D : forall i, (i <> 0 -> n = i * i)%Z -> / sqrt (IZR n) * IZR i = IZR (Z.sgn i)).
    { intros i Hi. destruct (Z.eq_dec i 0) as [->|NZ]; [cbn; ring|].
      rewrite (Hi NZ), <- sgn_div by exact NZ. unfold Rdiv. ring. }
    repeat split; cbn [tx ty tz vx vy vz]; (eapply holds_eq; [symmetry; apply D | apply holds_sgn]);
      intros; unfold n; destruct B as [[[X Y]|[X Y]]|[X Y]]; nia.
  - assert (Hn : (0 < n)%Z).
    { rewrite !orb_false_iff, !andb_false_iff, !Z.eqb_neq in B. unfold n. nia. }
    assert (E50 : / 2 ^ 50 <= V (2 ^ 14)) by (pose proof (power_neg 50 ltac:(lia)) as E; apply Req_le; exact E).
    destruct N as (NX & NY & NZ). cbn [vx vy vz scale A] in *.
    assert (T : forall i k', (i * i <= n)%Z -> Rabs (k' - / sqrt (IZR n) * IZR i) <= / 2 ^ 50 ->
      holds (const (unit_entry i n) (2 + 2 ^ 14)) s k').
    { intros i k' Hi Hk. apply holds_const. pose proof (unit_entry_ok i n Hn Hi) as E. rewrite V_add.
      replace (k' - V (unit_entry i n)) with ((k' - / sqrt (IZR n) * IZR i) + (IZR i / sqrt (IZR n) - V (unit_entry i n)))
        by (unfold Rdiv; ring).
      eapply Rle_trans; [apply Rabs_triang|]. lra. }
    repeat split; cbn [tx ty tz]; apply T; try assumption; unfold n; nia.
Qed.

(** ** Time, variables, elements *)

Definition time_tm (a b : Z) : tm := let c := ((a + b) / 2)%Z in Tm c (Z.max (b - c) (c - a)) 0 0.

Lemma time_ok a b t : V a <= t <= V b -> exists s, Rabs s <= 1 /\ holds (time_tm a b) s t.
Proof.
  intros [L U]. unfold time_tm. set (c := ((a + b) / 2)%Z). set (h := Z.max (b - c) (c - a)).
  assert (HL : V b - V c <= V h) by (rewrite <- V_sub; apply V_le; unfold h; lia).
  assert (HU : V c - V a <= V h) by (rewrite <- V_sub; apply V_le; unfold h; lia).
  assert (H : Rabs (t - V c) <= V h) by (apply Rabs_le; lra).
  destruct (Req_dec (V h) 0) as [Z0|NZ].
  - exists 0. split; [rewrite Rabs_R0; lra|]. unfold holds, poly; cbn [c0 c1 c2 rem]. rewrite V_0.
    apply Rabs_le. apply abs_in in H. lra.
  - assert (P : 0 < V h) by (pose proof (Rabs_pos (t - V c)); lra).
    exists ((t - V c) / V h). split.
    + unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ V h)) by (left; apply Rinv_0_lt_compat, P).
      apply Rmult_le_reg_r with (V h); [exact P|]. rewrite Rmult_assoc, Rinv_l by lra. lra.
    + unfold holds, poly; cbn [c0 c1 c2 rem]. rewrite V_0.
      replace (t - _) with 0 by (field; lra). rewrite Rabs_R0. lra.
Qed.

Fixpoint polynomial_tm (cs : list tm) (t : tm) : tm :=
  match cs with [] => tm_zero | c :: rest => tm_add c (tm_mul t (polynomial_tm rest t)) end.

Lemma polynomial_ok s cs t x : Rabs s <= 1 -> holds t s x ->
  holds (polynomial_tm (map tm_number cs) t) s (polynomial cs x).
Proof.
  intros Hs Ht. induction cs as [|c cs IH]; cbn; [apply holds_zero|].
  apply holds_add; [apply holds_number|]. apply holds_mul; assumption.
Qed.

Definition start_of (o : nat * (numbers3 * numbers3 * numbers3)) : nat * step :=
  let '(v, (a, b, c)) := o in (v, rotated a b c (Tvec tm_zero tm_zero tm_zero)).
Record spiece := Spiece { s_values : list (list tm); s_starts : list (nat * step) }.
Definition spiece_of (p : piece) : spiece :=
  Spiece (map (map tm_number) (polynomials p)) (map start_of (orientations p)).

(** The values of the variables, and where rotations begin. *)
Record sstate := Sstate { x_amount : list tm; x_start : list (nat * step) }.
Definition state_at (p : spiece) (t : tm) : sstate := Sstate (map (fun cs => polynomial_tm cs t) (s_values p)) (s_starts p).

(** The value of a variable at one time. *)
Definition value_tm (p : piece) (t : Z) (v : nat) : tm :=
  polynomial_tm (map tm_number (nth v (polynomials p) [])) (const t 0).
Lemma value_ok p t v : holds (value_tm p t v) 0 (value p (V t) v).
Proof. apply polynomial_ok; [rewrite Rabs_R0; lra | apply holds_exact]. Qed.

Definition starts (x : sstate) (v : nat) : list step :=
  match find (fun o => Nat.eqb (fst o) v) (x_start x) with Some o => [snd o] | None => [] end.

Definition holds_state (x : sstate) (s : R) (q : state) : Prop :=
  (forall v, holds (nth v (x_amount x) tm_zero) s (amount q v)) /\
  (forall v S, start_map (start q v) S -> holds_steps s (starts x v) S).

Lemma state_ok s p tmodel t : Rabs s <= 1 -> holds tmodel s t -> holds_state (state_at (spiece_of p) tmodel) s (at_time p t).
Proof.
  intros Hs Ht. split.
  - intros v. unfold state_at, spiece_of, at_time, value; cbn [x_amount amount s_values]. rewrite map_map.
    change tm_zero with ((fun cs => polynomial_tm (map tm_number cs) tmodel) []).
    rewrite map_nth. apply polynomial_ok; assumption.
  - intros v S. unfold starts, state_at, spiece_of, at_time, orientation; cbn [x_start start s_starts].
    induction (orientations p) as [|[u [[a b] c]] os IH]; cbn [map find fst snd start_of option_map].
    + intros H. apply no_step. exact H.
    + destruct (Nat.eqb u v); [|exact IH]. cbn [option_map snd start_map]. intros (m & R & E).
      apply first_step with (E := S) (M := fun x => x); [|apply no_step; reflexivity | reflexivity].
      eapply rotated_ok with (p := Vec 0 0 0); [exact R | repeat split; apply holds_zero|].
      intros x. rewrite E. destruct (apply m x) as [e f g]. unfold add; cbn [vx vy vz]. f_equal; ring.
Qed.

(** A rotation vector as a step. *)
Definition spin (w : tvec) : step :=
  match half_parts (tdot w w) with
  | Some (a, c) => Spun (tscale a w) c
  | None => let any := const 0 one in Spun (Tvec any any any) any
  end.

Lemma rotate_is_spun w x : rotate w x = spun (scale (sin_part (norm w) 1) w) (cos_part (norm w) 1) x.
Proof.
  assert (S : norm w * norm w = dot w w) by (apply sqrt_sqrt; unfold dot; nra).
  unfold rotate, sin_part, cos_part. destruct (Req_EM_T (norm w) 0) as [Z0|N].
  - rewrite Z0 in *. assert (w = Vec 0 0 0) as ->.
    { destruct w as [a b c]. unfold dot in S; cbn in S. assert (a = 0 /\ b = 0 /\ c = 0) as (-> & -> & ->); [|reflexivity].
      repeat split; nra. }
    replace (0 / 2 ^ 1) with 0 by field. unfold turn. rewrite cos_0, sin_0. destruct x as [x y z].
    unfold turn, spun, scale, cross, add, dot; cbn [vx vy vz]. f_equal; ring.
  - set (r := norm w) in *. rewrite pow_1. replace r with (2 * (r / 2)) at 2 by field. set (h := r / 2).
    pose proof (sin2_cos2 h) as SC. unfold Rsqr in SC. unfold turn. rewrite cos_2a_cos, sin_2a.
    replace (1 - (2 * cos h * cos h - 1)) with (2 * (sin h * sin h)) by lra.
    destruct w as [a b c], x as [x y z]. unfold spun, scale, cross, add, dot; cbn [vx vy vz]. f_equal; field; exact N.
Qed.

Lemma half_parts_square w : cos_part (norm w) 1 * cos_part (norm w) 1 +
  dot (scale (sin_part (norm w) 1) w) (scale (sin_part (norm w) 1) w) = 1.
Proof.
  assert (S : norm w * norm w = dot w w) by (apply sqrt_sqrt; unfold dot; nra).
  replace (dot (scale _ w) _) with (sin_part (norm w) 1 * sin_part (norm w) 1 * (norm w * norm w))
    by (rewrite S; unfold dot, scale; cbn [vx vy vz]; ring).
  pose proof (parts_double (norm w) 0) as [_ E]. pose proof (sin2_cos2 (norm w / 2)) as SC. unfold Rsqr in SC.
  unfold sin_part, cos_part in *. rewrite pow_1. destruct (Req_EM_T (norm w) 0) as [Z0|N].
  - rewrite Z0. replace (0 / 2) with 0 by field. rewrite cos_0. ring.
  - rewrite <- SC. clear E. field. exact N.
Qed.

Lemma spin_ok s w wv : Rabs s <= 1 -> holdsv w s wv -> holds_step s (spin w) (rotate wv).
Proof.
  intros Hs Hw. assert (S : norm wv * norm wv = dot wv wv) by (apply sqrt_sqrt; unfold dot; nra).
  pose proof (half_parts_square wv) as Q.
  assert (Hz : holds (tdot w w) s (norm wv * norm wv)) by (rewrite S; apply holds_dot; assumption).
  unfold spin. destruct (half_parts (tdot w w)) as [[a c]|] eqn:H.
  - destruct (half_parts_holds s (norm wv) _ _ (sqrt_pos _) Hs Hz H) as [Ha Hc]. cbn [fst snd] in *.
    eapply holds_spun; [apply holdsv_scale; [exact Hs | exact Ha | exact Hw] | exact Hc | exact Q | apply rotate_is_spun].
  - set (u := scale (sin_part (norm wv) 1) wv) in *. set (k := cos_part (norm wv) 1) in *.
    assert (A : forall x, x * x <= 1 -> holds (const 0 one) s x).
    { intros x Hx. apply holds_const. rewrite V_0, V_one, Rminus_0_r. apply Rabs_le. nra. }
    unfold dot in Q. apply holds_spun with (u := u) (c := k);
      [repeat split; cbn [tx ty tz]; apply A; nra | apply A; nra | unfold dot; exact Q | apply rotate_is_spun].
Qed.

(** An element, prepared. *)
Inductive selement :=
  | STurn (k : tvec) (v : nat) (m c : tm)
  | SSlide (k : tvec) (v : nat) (m c : tm)
  | SRotate (v : nat).
Definition selement_of (e : element) : selement :=
  match e with
  | Turn a v m c => STurn (axis_tm a) v (tm_number m) (tm_number c)
  | Slide a v m c => SSlide (axis_tm a) v (tm_number m) (tm_number c)
  | Rotate v => SRotate v
  end.
Definition steps_of (x : sstate) (e : selement) : list step :=
  let q v := nth v (x_amount x) tm_zero in
  match e with
  | STurn k v m c => let (sn, cs) := sincos (tm_add (tm_mul m (q v)) c) in [Turned k sn cs]
  | SSlide k v m c => [Slid k (tm_add (tm_mul m (q v)) c)]
  | SRotate v => spin (Tvec (q v) (q (v + 1)%nat) (q (v + 2)%nat)) :: starts x v
  end.

Lemma steps_of_ok s w q x e M M' N sts : Rabs s <= 1 -> holds_state x s q -> element_map w q e M M' -> holds_steps s sts N ->
  holds_steps s (steps_of x (selement_of e) ++ sts) (fun y => M (N y)).
Proof.
  intros Hs [Hq Hx] [a k v m c e' AM _ | a k v m c e' u AM _ _ | v S D HS _ R] HN; cbn [selement_of steps_of].
  - assert (H : holds (tm_add (tm_mul (tm_number m) (nth v (x_amount x) tm_zero)) (tm_number c)) s (real m * amount q v + real c))
      by (apply holds_add; [apply holds_mul; [exact Hs | apply holds_number | apply Hq] | apply holds_number]).
    pose proof (sincos_holds s _ _ Hs H) as SC. destruct (sincos _) as [sn cs]. cbn [fst snd] in SC. destruct SC as [S C].
    cbn [app]. eapply first_step; [|exact HN | reflexivity].
    apply holds_turned with (k := k) (sn := sin (real m * amount q v + real c)) (cs := cos (real m * amount q v + real c)); auto.
    + apply axis_ok. exact AM.
    + apply AM.
    + rewrite <- (sin2_cos2 (real m * amount q v + real c)). reflexivity.
  - assert (H : holds (tm_add (tm_mul (tm_number m) (nth v (x_amount x) tm_zero)) (tm_number c)) s (real m * amount q v + real c))
      by (apply holds_add; [apply holds_mul; [exact Hs | apply holds_number | apply Hq] | apply holds_number]).
    cbn [app]. eapply first_step with (E := fun y => add y (scale (real m * amount q v + real c) k)); [|exact HN | reflexivity].
    apply holds_slid with (k := k) (way := real m * amount q v + real c); auto. apply axis_ok. exact AM.
  - cbn [app]. eapply first_step with (E := rotate (Vec (amount q v) (amount q (v + 1)) (amount q (v + 2)))) (M := fun y => S (N y));
      [apply spin_ok; [exact Hs | repeat split; apply Hq] | | reflexivity].
    apply steps_app; [apply Hx; exact HS | exact HN].
Qed.

Lemma all_steps_ok s w q x es M M' : Rabs s <= 1 -> holds_state x s q -> elements_map w q es M M' ->
  holds_steps s (flat_map (steps_of x) (map selement_of es)) M.
Proof.
  intros Hs Hq H. induction H as [|e es E E' M M' HE HM IH]; cbn [map flat_map].
  - apply no_step. reflexivity.
  - eapply steps_of_ok; eassumption.
Qed.

(** ** Frames *)

Record sframe := Sframe { sparent : nat; sorigin : step; selements : list selement }.
Definition sframe_of (f : frame) : sframe := Sframe (parent f) (placed (origin f)) (map selement_of (elements f)).

Definition tree_of (fs : list sframe) (x : sstate) : tree :=
  map (fun f => (sparent f, sorigin f :: flat_map (steps_of x) (selements f))) fs.
Definition tree_at (fs : list sframe) (p : spiece) (a b : Z) : tree := tree_of fs (state_at p (time_tm a b)).

Lemma tree_ok w p tmodel t s P P' : Rabs s <= 1 -> holds tmodel s t -> frames_at w (at_time p t) P P' ->
  forall i k sts, nth_error (tree_of (map sframe_of (frames w)) (state_at (spiece_of p) tmodel)) i = Some (k, sts) ->
  exists E, holds_steps s sts E /\ forall x, P (S i) x = P k (E x).
Proof.
  intros Hs Ht (_ & _ & F) i k sts. unfold tree_of. rewrite map_map.
  rewrite nth_error_map. destruct (nth_error (frames w) i) as [f|] eqn:N; [|discriminate]. cbn.
  intros [= <- <-]. destruct (F i f N) as (O & G & M & M' & HO & _ & HM & X & _). exists (fun x => O (M x)). split.
  - apply first_step with (E := O) (M := M); [apply placed_ok; exact HO | | reflexivity].
    apply all_steps_ok with w (at_time p t) M'; [exact Hs | apply state_ok; assumption | exact HM].
  - exact X.
Qed.
